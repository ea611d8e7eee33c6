// The line over the canvas on a first visit: what the page is for, and two ways in.

import {button, element} from "../common/elements.js"
import {recall, remember} from "../common/storage.js"
import {skipLink} from "../page/skip_link.js"
import {stylesheet} from "../common/styles.js"
import {Uploader} from "../page/upload.js"

const styled = await stylesheet("widgets/welcome.css")
const SEEN = "cutcell welcomed"

/** @param {{model: Model}} widget */
export function render({model}) {
  if (recall(SEEN)) { return element("div") }
  const leave = () => { part.hidden = true; removeLink(); remember(SEEN, "1") }
  const go = () => { leave(); model.send_msg({type: "show-step", step: 0}) }
  const change = () => uploader.send(input.files)
  const input = element("input", {type: "file", multiple: true, hidden: true, on: {change}})
  const uploader = new Uploader(model, {ended: leave})
  const close = {className: "close", aria: {label: "Close the welcome"}, on: {click: leave}}
  const part = element("section", {aria: {label: "Welcome"}}, element("h2", {}, model.headline),
    button({className: "first", on: {click: go}}, "See why weights leak"),
    button({on: {click: () => input.click()}}, "Open my character"),
    button(close, "×"), input)
  const first = part.querySelector("button")
  const removeLink = skipLink("welcome", "Skip to the welcome", () => first)
  model.on("remove", removeLink)
  model.on("is_taught", leave)
  return element("div", {}, styled(), part)
}
