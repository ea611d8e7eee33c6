// In a narrow window the sidebar is a sheet at the bottom; the page above it is shorter by its height.

const NARROW = "(max-width: 599.95px)"
const HEIGHT = "46dvh"  // as layout/theme.py has it

export class Sheet {
  constructor(element) {
    this.fitted = () => this.fit()
    this.observer = new MutationObserver(this.fitted)
    this.beginning = requestAnimationFrame(() => this.begin(element))
  }

  // The page is the outermost element with a shadow tree.
  begin(element) {
    let root = element.getRootNode()
    while (root.host?.getRootNode().host) { root = root.host.getRootNode() }
    this.root = root
    root.querySelector("main")?.setAttribute("aria-label", "Character")
    root.querySelector("nav")?.setAttribute("aria-label", "Controls")
    this.observer.observe(root, {childList: true, subtree: true})
    root.addEventListener("transitionend", this.fitted, true)
    this.fit()
  }

  fit() {
    const sheet = this.root.querySelector(".MuiDrawer-modal .MuiDrawer-paper")
    const open = sheet && matchMedia(NARROW).matches && getComputedStyle(sheet).visibility !== "hidden"
    document.documentElement.style.setProperty("--sheet", open ? HEIGHT : "0px")
    if (!open) { return }
    // Its layer covers the whole window.
    for (let part = sheet.parentElement; part; part = part.parentElement) {
      part.style.pointerEvents = "none"
      if (part.matches("[data-pmui-layer]")) { break }
    }
    // What lies beside the sheet is no background: it is what the sheet is for.
    for (const hidden of this.root.querySelectorAll(":scope > [aria-hidden=true]")) {
      hidden.removeAttribute("aria-hidden")
    }
  }

  remove() {
    cancelAnimationFrame(this.beginning)
    this.observer.disconnect()
    this.root?.removeEventListener("transitionend", this.fitted, true)
  }
}
