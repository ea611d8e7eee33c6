// The tour's card: one step at a time; the formula as MathML, which browsers draw and read out.

import {stylesheet} from "./styles.js"

const styled = await stylesheet("tour_card.css")

// A face that is declared within a part of the page is not taken: it is the document's.
const face = new FontFace("cutcell math", `url(${new URL("math.woff", import.meta.url)})`)
face.load().then(() => document.fonts.add(face)).catch(() => {})

function loadKatex(url) {
  window.__cutcellKatex ??= new Promise((resolve) => {
    if (window.katex) { resolve(window.katex); return }
    const script = document.createElement("script")
    script.src = new URL(url, document.baseURI).href
    script.addEventListener("load", () => resolve(window.katex))
    script.addEventListener("error", () => resolve(null))
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

  // The button that starts the tour is gone then; a page that opens on a step keeps its focus.
  let shown = false
  const show = async () => {
    const step = model.steps[model.step]
    const entering = card.hidden && shown
    shown = true
    card.hidden = !step
    if (!step) { return }
    count.textContent = `Step ${model.step + 1} of ${model.steps.length}`
    title.textContent = step.title
    body.replaceChildren(...step.text.split("\n\n").map((text) => make("p", "", text)))
    const formula = make("div", "formula")
    const offers = make("div", "offers")
    offers.setAttribute("role", "group")
    offers.setAttribute("aria-label", "Try it")
    step.offers.forEach((label, index) => {
      const offer = make("button", "offer", label)
      offer.type = "button"
      offer.addEventListener("click", () => model.send_msg({type: "offer", index}))
      offers.append(offer)
    })
    body.append(formula, make("p", "look", step.task), ...step.offers.length ? [offers] : [])
    press()
    back.disabled = model.step === 0
    next.textContent = model.step + 1 < model.steps.length ? "Next" : "Done"
    ;[...dots.children].forEach((dot, i) => {
      if (i === model.step) { dot.setAttribute("aria-current", "step") } else { dot.removeAttribute("aria-current") }
    })
    card.scrollTop = 0
    if (entering) { title.focus({preventScroll: true}) }
    const katex = await loadKatex(model.katex_url)
    if (!katex) { formula.textContent = step.formula; return }
    formula.innerHTML = katex.renderToString(step.formula, {
      output: "mathml", displayMode: true, throwOnError: false,
    })
  }

  // Shows which of the step's buttons are chosen.
  const press = () => [...card.querySelectorAll(".offer")].forEach((offer, i) => {
    offer.setAttribute("aria-pressed", Boolean(model.taken[i]))
  })

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
  model.on("taken", press)
  show()
  const root = make("div")
  root.style.cssText = "display: flex; width: 100%; min-width: 0; min-height: 0"
  root.append(styled(), card)
  return root
}
