// The window of the speaker's notes: it follows the lesson in another window of the same browser.

import {button, element} from "../common/elements.js"
import {channel} from "./stage.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("lesson/notes.css")

/** @param {{model: {steps: Step[], on(name: string, act: () => void): void}}} widget */
export function render({model: {steps, on}}) {
  const walk = (act) => ({on: {click: () => lesson.tell({act})}})
  const title = element("h2", {}, "Open a step of the lesson in another window.")
  const body = element("div")
  const part = element("section", {aria: {label: "Notes", live: "polite"}}, title, body,
    element("footer", {}, button(walk("backward"), "Back"), button(walk("forward"), "Next")))
  const line = (label, text) =>
    text ? [element("p", {}, element("b", {}, `${label} `), text)] : []
  const lesson = channel(({step: number}) => {
    const step = steps[number]
    if (!step) { return }
    title.textContent = `${number + 1} of ${steps.length}: ${step.title}`
    const next = steps[number + 1]
    const {expected} = step.answer
    body.replaceChildren(
      ...line("Question", step.question),
      ...expected === undefined ? [] : line("Answer", [expected].flat().join(", ")),
      ...step.notes.split(/\n\s*\n/).map((one) => element("p", {className: "notes"}, one)),
      ...line("Remains", step.sentence), ...line("Next", next?.title))
  })
  const keys = (e) => {
    const act = {PageDown: "forward", ArrowRight: "forward", PageUp: "backward",
      ArrowLeft: "backward"}[e.key]
    if (act) { e.preventDefault(); lesson.tell({act}) }
  }
  document.addEventListener("keydown", keys)
  on?.("remove", () => { document.removeEventListener("keydown", keys); lesson.close() })
  lesson.tell({act: "report"})
  return element("div", {}, styled(), part)
}
