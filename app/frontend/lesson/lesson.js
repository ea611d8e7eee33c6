// The lesson on a page with a server: the card, whose host is the server, and the presentation.

import {lessonCard} from "./card.js"
import {Stage} from "./stage.js"

/** @param {{model: Model}} widget */
export function render({model}) {
  const {steps} = model
  const host = {
    go: (step) => model.send_msg({type: "show-step", step}),
    answer: (value) => model.send_msg({type: "answer", value}),
    offer: (index) => model.send_msg({type: "offer", index}),
    set: (name, value) => model.send_msg({type: "choose-value", name, value}),
    stage: (on) => model.send_msg({type: "stage", on}),
  }
  const card = lessonCard(steps, host, ["picture", "flat"])
  const stage = new Stage(card, host)
  const show = () => {
    card.show(model.now)
    stage.show(model.now)
  }
  model.on("now", show)
  model.on("remove", () => { card.remove(); stage.remove() })
  show()
  return card.root
}
