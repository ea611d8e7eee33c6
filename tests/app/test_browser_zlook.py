"""Look at Weights and Check with all open."""
import re
import pytest
from tests.app.conftest import *
from tests.conftest import *
from tests.app.browser import Visit, served
from tests.app.small import SMALL
from tests.app.test_browser_accessibility import faults, FADED, OVER
OUT="/tmp/mend/shots"
import os; os.makedirs(OUT,exist_ok=True)

@pytest.mark.parametrize(("size","theme"),[((1100,900),"light"),((1100,900),"dark"),((390,844),"light"),((390,844),"dark")])
def test_look(browser,url,size,theme):
    tag=f"{size[0]}-{theme}"
    v=Visit(browser,url+SMALL+"&panel=weights",viewport={"width":size[0],"height":2600 if size[0]>400 else 844},color_scheme=theme,device_scale_factor=1)
    v.page.get_by_text(re.compile("vertices")).first.wait_for()
    v.settle(); 
    if size[0]>400: v.wait_until_bound()
    try: v.dismiss()
    except Exception as e: print("dismiss",e)
    out=[]
    def shot(name):
        v.settle(); v.page.evaluate(FADED); v.page.screenshot(path=f"{OUT}/{tag}-{name}.png")
        out.extend(f"{tag} {name}: {f}" for f in faults(v,besides=OVER))
    def item(menu,name):
        v.reach(v.button(menu)); v.button(menu).click(); v.page.get_by_role("menuitem",name=name,exact=True).click(); v.settle()
    if size[0]<400:
        # open the drawer
        v.page.screenshot(path=f"{OUT}/{tag}-start.png")
    print([b.inner_text() or b.get_attribute("aria-label") for b in v.page.get_by_role("button").all() if b.is_visible()][:60])
    if theme=="dark" and v.button("Toggle theme").count(): v.button("Toggle theme").click()
    v.unfold()
    item("Select by","All")
    item("Add layer","From file")
    v.unfold()
    shot("weights")
    v.button("Mask").click(); v.page.get_by_role("menu").wait_for(); shot("mask-menu"); v.page.keyboard.press("Escape"); v.page.get_by_role("menu").wait_for(state="hidden")
    for m in ("Change weights","Select by","Add layer"):
        v.button(m).click(); v.page.get_by_role("menu").wait_for(); shot("menu-"+m.replace(" ","-")); v.page.keyboard.press("Escape"); v.page.get_by_role("menu").wait_for(state="hidden")
    v.page.get_by_role("combobox",name="Mode",exact=True).click(); v.page.get_by_role("menu").wait_for(); shot("mode"); v.page.keyboard.press("Escape"); v.page.get_by_role("menu").wait_for(state="hidden")
    v.page.get_by_role("tab",name="Check").click(); v.settle(); v.unfold()
    for b in v.page.get_by_role("button",name=re.compile("^(error|warning|info|Components|Unreach|Noisy|Left)")).all()[:6]:
        print("finding",b.inner_text())
    shot("check")
    first=v.page.get_by_role("button",name=re.compile("Unreachable|Components|Noisy")).first
    if first.count(): first.click(); v.settle(); shot("check-open")
    v.context.close()
    print("\n".join(out)); assert not out
