// The line over the canvas on a first visit: what the page is for, and three ways in.

import {recall, remember} from "./storage.js"
import {stylesheet} from "./styles.js"
import {Uploader} from "./upload.js"

const styled = await stylesheet("welcome.css")
const SEEN = "cutcell welcomed"

export function render({model}) {
  const root = document.createElement("div")
  if (recall(SEEN)) { return root }
  const part = document.createElement("section")
  part.setAttribute("aria-label", "Welcome")
  const heading = document.createElement("h2")
  heading.textContent = model.headline
  const leave = () => { part.hidden = true; remember(SEEN, "1") }
  const button = (text, className, act) => {
    const made = document.createElement("button")
    Object.assign(made, {type: "button", textContent: text, className})
    made.addEventListener("click", act)
    return made
  }
  const input = document.createElement("input")
  Object.assign(input, {type: "file", multiple: true, hidden: true})
  const uploader = new Uploader(model, {started: () => {}, moved: () => {}, ended: leave})
  input.addEventListener("change", () => uploader.send(input.files))
  const go = (step) => () => { leave(); model.send_msg({type: "step", step}) }
  const close = button("×", "close", leave)
  close.setAttribute("aria-label", "Close the welcome")
  part.append(heading, button("See why weights leak", "first", go(model.leak)),
    button("Open my character", "", () => input.click()), button("Learn", "", go(0)), close, input)
  model.on("touring", leave)
  root.append(styled(), part)
  return root
}
