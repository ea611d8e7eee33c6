"""Puts the pictures of `cutcell_viewers.show` into the gallery: what a script calls `picture`."""

from sphinx_gallery.scrapers import figure_rst


def save_picture(block, block_vars, gallery_conf):
    """Save the variable `picture` of a block, if it was set there, and return its markup."""
    picture = block_vars["example_globals"].pop("picture", None)
    if picture is None:
        return ""
    path = next(block_vars["image_path_iterator"])
    picture.save(path)
    return figure_rst([path], gallery_conf["src_dir"])


def _get_sg_image_scraper():
    return save_picture
