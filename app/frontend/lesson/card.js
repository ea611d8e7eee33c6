// The card of a lesson: a question, an answer, then what the picture shows. It does not depend on
// the server, so that the page in one file uses it, too.
//
// `lessonCard(steps, host)` returns {root, show(now), remove()}. The host does what a person asks:
//   go(step)          show another step; -1 leaves the lesson
//   answer(value)     commit to an answer: an option, a number; "" shows the answer without one
//   offer(index)      press a button of the step
//   set(name, value)  set a choice of the page, from a number in the text
//   stage(on)         begin or end the presentation
// It calls show(now) whenever one of these has changed:
//   step     the step that is shown; -1 for none
//   answers  what was answered so far, by step; a step that has one is revealed
//   pressed  for each button of the step, whether what it chooses is chosen
//   values   choices of the page that the step's text names, by name, as `sentence.js` needs them
//   plot     a plot of `learn/plots.py` beside the text, or null; may be left out
//   scores   agreement of what was painted with each method that is compared; may be left out
//   staged   whether the lesson is presented
// The host answers for the picture: where the answer is a click or a stroke there, it puts the name
// of the clicked joint, or of the joint that the clicked vertex follows, or the score of what was
// painted, from 0 to 1, into `answers`. `can` contains `picture` in this case, and `flat` if the
// flat scene reports what a person does there; else there are options.

import {button, element, elementsWithKey} from "../common/elements.js"
import {judge, total} from "./score.js"
import {sentence} from "./sentence.js"
import {smallPlot} from "./small_plot.js"
import {stylesheet} from "../common/styles.js"

const sheets = await Promise.all([
  stylesheet("lesson/card.css"), stylesheet("lesson/sentence.css"),
  stylesheet("lesson/small_plot.css")])

const TYPED = "input, textarea, [role=slider], [role=listbox]"
const IN_PICTURE = ["vertex", "joint", "paint"]

/** @param {Step[]} steps @param {LessonHost} host */
export function lessonCard(steps, host, can = ["picture"]) {
  const to = (className, text, step) =>
    button({className, on: {click: () => host.go(step())}}, text)
  let now = {step: -1, answers: {}, pressed: [], values: {}, staged: false}
  const count = element("span")
  const title = element("h2", {tabIndex: -1})
  const body = element("div")
  const live = element("div", {aria: {live: "polite"}}, title, body)
  const back = to("go", "Back", () => now.step - 1)
  const after = () => now.step + 1 < steps.length ? now.step + 1 : -1
  const next = to("go next", "Next", after)
  const dots = element("div", {className: "dots", aria: {role: "group", label: "Steps"}},
    ...steps.map(({title}, i) => button(
      {title, aria: {label: `Step ${i + 1}: ${title}`}, on: {click: () => host.go(i)}},
      element("i"))))
  const present = button({className: "close", on: {click: () => host.stage(true)}}, "Present")
  const card = element("article", {aria: {label: "Lesson"}},
    element("header", {}, count, present, to("close", "Leave", () => -1)), live,
    element("footer", {}, back, dots, next))

  const isRevealed = () => now.step in now.answers
  // A step is revealed first; the next one follows.
  const forward = () => {
    if (!isRevealed()) { host.answer("") } else if (after() > 0) { host.go(after()) }
  }
  const backward = () => { if (now.step > 0) { host.go(now.step - 1) } }

  const said = element("p")  // of the answer
  const plot = smallPlot()
  let texts = []  // with numbers that are dragged
  let shown = null  // the step and the answer that are written
  const show = (state) => {
    now = state
    const step = steps[now.step]
    const entering = card.hidden && shown !== null
    card.hidden = !step
    if (!step) { shown = ""; return }
    const written = JSON.stringify([now.step, now.answers[now.step]])
    if (written !== shown) {
      shown = written
      write(step)
    }
    card.classList.toggle("staged", now.staged)
    card.classList.toggle("revealed", isRevealed())
    ;[...card.querySelectorAll(".offer")].forEach((offer, i) => {
      offer.setAttribute("aria-pressed", String(Boolean(now.pressed[i])))
    })
    for (const one of texts) { one.show(now.values) }
    const verdict = judge(step.answer, now.answers[now.step], now.scores)
    said.textContent = verdict?.text ?? ""
    said.className = verdict?.right ? "right" : "wrong"
    plot.show(isRevealed() ? now.plot : null)
    if (entering) { title.focus({preventScroll: true}) }
  }

  const write = (step) => {
    const {right, of} = total(steps, now.answers)
    count.textContent = `Step ${now.step + 1} of ${steps.length}`
      + (of ? ` · ${right} of ${of} right` : "")
    title.textContent = step.title
    body.replaceChildren(element("p", {className: "question"}, step.question),
      ...isRevealed() ? revealed(step) : asked(step))
    back.disabled = now.step === 0
    next.textContent = after() < 0 ? "Done" : "Next"
    next.classList.toggle("quiet", !isRevealed())
    ;[...dots.children].forEach((dot, i) => {
      dot.setAttribute("aria-current", i === now.step ? "step" : "false")
      dot.classList.toggle("answered", i in now.answers)
    })
    card.scrollTop = 0
  }

  const asked = (step) => {
    const {answer} = step
    const give = (label) =>
      button({className: "option", on: {click: () => host.answer(label)}}, label)
    const skip = button({className: "skip", on: {click: () => host.answer("")}}, "Show me")
    const ways = []
    if (answer.kind === "number") { ways.push(numberForm(answer)) }
    const isPicture = can.includes(answer.kind === "act" ? "flat" : "picture")
      && [...IN_PICTURE, "act"].includes(answer.kind)
    if (!isPicture) { ways.push(...(answer.options ?? []).map(give)) }
    if (isPicture && answer.kind === "paint") {
      ways.push(give(answer.button ?? "Done"))
    }
    const how = answer.prompt ? [element("p", {className: "look"}, answer.prompt)] : []
    const isTried = answer.kind === "act" && answer.expected === undefined  // any button answers
    const offers = isTried ? offersOf(step) : []
    const group = {className: "answers", aria: {role: "group", label: "Your answer"}}
    return [...how, ...offers, element("div", group, ...ways, skip)]
  }

  const numberForm = (answer) => {
    const aria = {label: `Your answer${answer.unit ? ` in ${answer.unit}` : ""}`}
    const input = element("input",
      {type: "number", step: "any", required: true, inputMode: "decimal", aria})
    const submit = (e) => { e.preventDefault(); host.answer(Number(input.value)) }
    return element("form", {on: {submit}}, input, answer.unit ?? "",
      element("button", {className: "option"}, "Answer"))
  }

  const revealed = (step) => {
    texts = step.text.split("\n\n").filter(Boolean).map((one) =>
      sentence(one, now.values, (name, value) => host.set(name, value)))
    const offers = offersOf(step)  // which change the plot, where there is one
    const parts = [said, plot.node, ...step.plot ? offers : [], ...texts.map(({node}) => node)]
    if (step.picture) { parts.push(element("p", {className: "unseen"}, step.picture)) }
    if (!step.plot) { parts.push(...offers) }
    if (step.sentence) { parts.push(element("p", {className: "sentence"}, step.sentence)) }
    return parts
  }

  const offersOf = ({offers}) => {
    if (!offers.length) { return [] }
    const press = (i) => () => {
      host.offer(i)
      if (!isRevealed()) { host.answer(offers[i]) }
    }
    const buttons = offers.map((label, i) =>
      button({className: "offer", on: {click: press(i)}}, label))
    const group = {className: "offers", aria: {role: "group", label: "Try it"}}
    return [element("div", group, ...buttons)]
  }

  const pressed = (e) => {
    if (card.hidden || e.ctrlKey || e.metaKey || e.altKey || e.defaultPrevented) { return }
    const path = elementsWithKey(e)
    if (path.some((part) => part.matches(TYPED))) { return }
    if (e.key === "PageDown") { e.preventDefault(); forward() }
    if (e.key === "PageUp") { e.preventDefault(); backward() }
    if (e.key === "Escape" && path.includes(card)) { host.go(-1) }
  }
  document.addEventListener("keydown", pressed)
  const remove = () => document.removeEventListener("keydown", pressed)
  const root = element("div", {}, ...sheets.map((styled) => styled()), card)
  root.style.cssText = "display: flex; width: 100%; min-width: 0; min-height: 0"
  return {root, show, remove, forward, backward}
}
