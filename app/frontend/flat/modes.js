// Modes of the flat scene. Each has seen() (the box that is seen), buttons(), say(),
// press(point, isNew), key(name), which returns whether the key means anything, and tick(now),
// whether something runs. reveal() shows the answer of a step, where there is one.

import {Graph} from "./graph.js"
import {Paths} from "./paths.js"
import {Rays} from "./rays.js"

export const MODES = {rays: Rays, winding: Rays, graph: Graph, search: Paths}
