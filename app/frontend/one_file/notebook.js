// The interactive page as a widget of a notebook (app/headless/notebook_widget.py): a frame with
// the page, which chooses what the model chooses, and the other way round (standalone.js).

const CHOSEN = ["joint", "vertex"]

function render({model, el}) {
  const frame = document.createElement("iframe")
  Object.assign(frame.style, {width: "100%", height: `${model.get("height")}px`, border: 0})
  frame.sandbox = "allow-scripts allow-downloads"  // nothing of the notebook is in its reach
  frame.srcdoc = model.get("content")
  const send = (name) => frame.contentWindow?.postMessage({cutcell: {[name]: model.get(name)}}, "*")
  const listeners = CHOSEN.map((name) => [`change:${name}`, () => send(name)])
  const receive = ({source, data}) => {
    const message = data?.cutcell
    if (source !== frame.contentWindow || !message) { return }
    if (message === "ready") { CHOSEN.forEach(send); return }
    for (const [name, value] of Object.entries(message)) { model.set(name, value) }
    model.save_changes()
  }
  window.addEventListener("message", receive)
  for (const [event, act] of listeners) { model.on(event, act) }
  el.append(frame)
  return () => {
    window.removeEventListener("message", receive)
    for (const [event, act] of listeners) { model.off(event, act) }
  }
}

export default {render}
