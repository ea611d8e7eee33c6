// The tour's card: one step at a time; the formula as MathML, which browsers draw and read out.

const TOUR_STYLE = `
:host { pointer-events: none; }
article { pointer-events: auto; box-sizing: border-box; width: 100%; min-width: 0; max-height: 100%; overflow: hidden auto;
  padding: 16px 20px 14px; border-radius: 14px; font: 14px/1.5 Roboto, system-ui, sans-serif;
  color: var(--mui-palette-text-primary, #1f2632);
  background: color-mix(in srgb, var(--mui-palette-background-paper, #fff) 94%, transparent);
  backdrop-filter: blur(8px); box-shadow: 0 6px 28px rgba(10, 20, 40, .2); }
article[hidden] { display: none; }
header { display: flex; justify-content: space-between; align-items: center; gap: 8px; }
header span { font-size: 12px; color: var(--mui-palette-text-secondary, #5c6675); }
h2 { font-size: 17px; line-height: 1.25; font-weight: 600; margin: 2px 0 8px; outline: none; }
p { margin: 0 0 9px; }
.formula { overflow-x: auto; padding: 8px 0; margin: 0 0 9px; text-align: center; font-size: 15px;
  border-block: 1px solid color-mix(in srgb, currentColor 14%, transparent); }
.look { padding-left: 12px; border-left: 3px solid #e05a00; }
footer { display: flex; align-items: center; justify-content: space-between; gap: 8px;
  position: sticky; bottom: -14px; padding: 8px 0 10px; margin-bottom: -10px;
  background: var(--mui-palette-background-paper, #fff); }
.dots { display: flex; }
.dots button { all: unset; width: 15px; height: 24px; display: grid; place-items: center; cursor: pointer; }
.dots i { width: 7px; height: 7px; border-radius: 50%; background: currentColor; opacity: .28; }
.dots [aria-current] i { opacity: 1; background: #e05a00; transform: scale(1.25); }
.go { all: unset; padding: 6px 13px; border-radius: 8px; cursor: pointer; font-weight: 500;
  color: var(--mui-palette-primary-main, #17678c); }
.go.next { color: var(--mui-palette-primary-contrastText, #fff);
  background: var(--mui-palette-primary-main, #17678c); }
.go:disabled { opacity: .35; cursor: default; }
.close { all: unset; padding: 3px 8px; border-radius: 6px; cursor: pointer; font-size: 13px;
  color: var(--mui-palette-text-secondary, #5c6675); }
button:focus-visible { outline: 2px solid #e05a00; outline-offset: 1px; }
@media (max-width: 1180px) { article { max-height: calc((100dvh - 100px) / 2); } }
@media (max-width: 700px) { article { padding: 12px 14px 10px; font-size: 13.5px; } }
`

function loadKatex(url) {
  window.__cutcellKatex ??= new Promise((resolve) => {
    if (window.katex) { resolve(window.katex); return }
    const script = document.createElement("script")
    script.src = new URL(url, document.baseURI).href
    script.onload = () => resolve(window.katex)
    script.onerror = () => resolve(null)
    document.head.append(script)
  })
  return window.__cutcellKatex
}

export function render({model}) {
  const make = (tag, className, text) => {
    const element = document.createElement(tag)
    if (className) { element.className = className }
    if (text !== undefined) { element.textContent = text }
    return element
  }
  const style = make("style", "", TOUR_STYLE)
  const card = make("article")
  card.setAttribute("aria-label", "Tour")
  const count = make("span")
  const close = make("button", "close", "Leave")
  const head = make("header")
  head.append(count, close)
  const title = make("h2")
  title.tabIndex = -1
  const body = make("div")
  body.setAttribute("aria-live", "polite")
  const back = make("button", "go", "Back")
  const next = make("button", "go next", "Next")
  const dots = make("div", "dots")
  dots.setAttribute("role", "group")
  dots.setAttribute("aria-label", "Steps")
  const foot = make("footer")
  foot.append(back, dots, next)
  card.append(head, title, body, foot)

  const ask = (step) => model.send_msg({type: "step", step})
  model.steps.forEach((step, i) => {
    const dot = make("button")
    dot.append(make("i"))
    dot.setAttribute("aria-label", `Step ${i + 1}: ${step.title}`)
    dot.title = step.title
    dot.addEventListener("click", () => ask(i))
    dots.append(dot)
  })
  back.addEventListener("click", () => ask(model.step - 1))
  next.addEventListener("click", () => ask(model.step + 1 < model.steps.length ? model.step + 1 : -1))
  close.addEventListener("click", () => ask(-1))
  for (const button of card.querySelectorAll("button")) { button.type = "button" }

  const show = async () => {
    const step = model.steps[model.step]
    card.hidden = !step
    if (!step) { return }
    count.textContent = `Step ${model.step + 1} of ${model.steps.length}`
    title.textContent = step.title
    body.replaceChildren(...step.text.split("\n\n").map((text) => make("p", "", text)))
    const formula = make("div", "formula")
    body.append(formula, make("p", "look", step.task))
    back.disabled = model.step === 0
    next.textContent = model.step + 1 < model.steps.length ? "Next" : "Done"
    ;[...dots.children].forEach((dot, i) => {
      if (i === model.step) { dot.setAttribute("aria-current", "step") } else { dot.removeAttribute("aria-current") }
    })
    card.scrollTop = 0
    const katex = await loadKatex(model.katex_url)
    if (!katex) { formula.textContent = step.formula; return }
    formula.innerHTML = katex.renderToString(step.formula, {
      output: "mathml", displayMode: true, throwOnError: false,
    })
  }

  const pressed = (e) => {
    if (card.hidden || e.ctrlKey || e.metaKey || e.altKey || e.defaultPrevented) { return }
    const path = e.composedPath().filter((part) => part instanceof Element)
    if (path.some((part) => part.matches("input, textarea, [role=slider], [role=listbox]"))) { return }
    if (e.key === "PageDown" && model.step + 1 < model.steps.length) { e.preventDefault(); ask(model.step + 1) }
    if (e.key === "PageUp" && model.step > 0) { e.preventDefault(); ask(model.step - 1) }
    if (e.key === "Escape" && e.composedPath().includes(card)) { ask(-1) }
  }
  document.addEventListener("keydown", pressed)
  model.on("remove", () => document.removeEventListener("keydown", pressed))
  model.on("step", show)
  show()
  const root = make("div")
  root.style.cssText = "display: flex; width: 100%; min-width: 0; min-height: 0"
  root.append(style, card)
  return root
}
