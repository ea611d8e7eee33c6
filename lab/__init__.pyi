from . import baselines as baselines
from . import dataset as dataset
from . import metrics as metrics
from . import networks as networks
from .baselines.compare import compare as compare
