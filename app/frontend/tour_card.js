// The tour's card: one step at a time; the formula as MathML, which browsers draw and read out.

import {button, element} from "./elements.js"
import {stylesheet} from "./styles.js"

const styled = await stylesheet("tour_card.css")

// A face that is declared within a part of the page is not taken: it is the document's.
const face = new FontFace("cutcell math", `url(${new URL("math.woff", import.meta.url)})`)
face.load().then(() => document.fonts.add(face)).catch(() => {})

function loadKatex(url) {
  window.__cutcellKatex ??= new Promise((resolve) => {
    if (window.katex) { resolve(window.katex); return }
    const on = {load: () => resolve(window.katex), error: () => resolve(null)}
    document.head.append(element("script", {src: new URL(url, document.baseURI).href, on}))
  })
  return window.__cutcellKatex
}

export function render({model}) {
  const ask = (step) => model.send_msg({type: "step", step})
  const to = (className, text, step) => button({className, on: {click: () => ask(step())}}, text)
  const count = element("span")
  const title = element("h2", {tabIndex: -1})
  const body = element("div", {aria: {live: "polite"}})
  const back = to("go", "Back", () => model.step - 1)
  const next = to("go next", "Next", () => model.step + 1 < model.steps.length ? model.step + 1 : -1)
  const dots = element("div", {className: "dots", aria: {role: "group", label: "Steps"}},
    ...model.steps.map(({title}, i) => button(
      {title, aria: {label: `Step ${i + 1}: ${title}`}, on: {click: () => ask(i)}}, element("i"))))
  const card = element("article", {aria: {label: "Tour"}},
    element("header", {}, count, to("close", "Leave", () => -1)), title, body,
    element("footer", {}, back, dots, next))

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
    body.replaceChildren(...step.text.split("\n\n").map((text) => element("p", {}, text)))
    const formula = element("div", {className: "formula"})
    const offers = step.offers.map((label, index) => button(
      {className: "offer", on: {click: () => model.send_msg({type: "offer", index})}}, label))
    body.append(formula, element("p", {className: "look"}, step.task))
    if (offers.length) {
      body.append(element("div", {className: "offers", aria: {role: "group", label: "Try it"}}, ...offers))
    }
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
  const root = element("div", {}, styled(), card)
  root.style.cssText = "display: flex; width: 100%; min-width: 0; min-height: 0"
  return root
}
