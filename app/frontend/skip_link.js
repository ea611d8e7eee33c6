// The first thing that Tab reaches: a link over the sidebar's controls to the canvas.

const PLACE = "position: fixed; z-index: 2000; left: 12px; padding: 8px 14px; border-radius: 8px;" +
  "outline: 2px solid #e05a00; font: 500 14px Roboto, system-ui, sans-serif; color: #1f2632; background: #fff;"

export function skipLink(canvas) {
  const link = Object.assign(document.createElement("a"), {href: "#canvas", textContent: "Skip to the canvas"})
  const show = (seen) => { link.style.cssText = PLACE + `top: ${seen ? 8 : -80}px` }
  link.addEventListener("focus", () => show(true))
  link.addEventListener("blur", () => show(false))
  link.addEventListener("click", (e) => { e.preventDefault(); canvas.focus() })
  show(false)
  document.body.prepend(link)
  return link
}
