// A histogram whose bars are chosen by clicks, by dragging across them, or by keys and Shift.

import {button, drawn, h, span} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/histogram.css")
const LOWEST = 4  // percent of the height, of bars with anything in them

/** @param {{model: Model}} widget */
export function render({model}) {
  let begun = null, ended = null
  const choose = (a, b) =>
    model.send_msg({type: "pick-bars", first: Math.min(a, b), last: Math.max(a, b)})
  const from = (e, bar) => e.shiftKey && model.chosen.length ? model.chosen[0] : bar
  const barAt = (e) => {
    const {left, width} = e.currentTarget.getBoundingClientRect()
    const at = Math.floor((e.clientX - left) / width * model.bars.length)
    return Math.min(Math.max(at, 0), model.bars.length - 1)
  }
  const end = () => { begun = null }
  const pointer = {
    onpointerdown: (e) => {
      ended = barAt(e)
      begun = from(e, ended)
      e.currentTarget.setPointerCapture(e.pointerId)
      choose(begun, ended)
    },
    onpointermove: (e) => {
      if (begun === null || barAt(e) === ended) { return }
      ended = barAt(e)
      choose(begun, ended)
    },
    onpointerup: end,
    onpointercancel: end,
  }
  const draw = () => {
    const most = Math.max(1, ...model.bars.map(([, count]) => count))
    const [first, last] = model.chosen
    const bars = model.bars.map(([range, count], i) => {
      const label = `${range}: ${count.toLocaleString("en")}`
      const height = `${count ? Math.max(100 * count / most, LOWEST) : 0}%`
      // Pointers are heard by the whole; keys press the button.
      const click = (e) => { if (!e.detail) { choose(from(e, i), i) } }
      return button({
        "title": label, "aria-label": label, "aria-pressed": String(first <= i && i <= last),
        "onclick": click,
      }, h("i", {style: {height}}))
    })
    const about = {"class": "bars", "role": "group", "aria-label": model.label}
    return [
      h("div", {...about, hidden: !bars.length, ...pointer}, bars),
      h("div", {class: "ends"}, span("", "0"), span("", "1")),
    ]
  }
  return drawn(model, ["bars", "chosen"], styled, draw)
}
