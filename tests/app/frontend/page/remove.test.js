// What listens is let go: nothing is heard, drawn or sent after remove().
import assert from "node:assert/strict"
import {test} from "node:test"

import {eachFrame} from "../../../../app/frontend/common/frames.js"
import {Orbit} from "../../../../app/frontend/camera/orbit.js"
import {onConnectionLost} from "../../../../app/frontend/common/panel.js"
import {onPixelRatio} from "../../../../app/frontend/common/pixel_ratio.js"
import {Uploader} from "../../../../app/frontend/page/upload.js"

// Stands for the media queries of a browser, one for each pixel ratio.
function screens() {
  const queries = []
  globalThis.devicePixelRatio = 1
  globalThis.matchMedia = (media) => {
    queries.push(Object.assign(new EventTarget(), {media}))
    return queries.at(-1)
  }
  return (ratio) => {
    const before = queries.at(-1)
    globalThis.devicePixelRatio = ratio
    before.dispatchEvent(new Event("change"))
  }
}

test("each change of the pixel ratio is heard until nobody listens", () => {
  const move = screens()
  let heard = 0
  const forget = onPixelRatio(() => { heard += 1 })
  move(2)
  move(1.5)
  assert.equal(heard, 2)
  forget()
  move(1)
  assert.equal(heard, 2)
})

test("frames end when they are stopped, and long ones count for a tenth of a second", () => {
  const waiting = new Map()
  let count = 0
  globalThis.requestAnimationFrame = (act) => { waiting.set(count += 1, act); return count }
  globalThis.cancelAnimationFrame = (id) => waiting.delete(id)
  const draw = (now) => {
    const [id, act] = [...waiting].at(-1)
    waiting.delete(id)
    act(now)
  }
  const passed = []
  const stop = eachFrame((seconds) => passed.push(seconds))
  for (const now of [1000, 1016, 3000]) { draw(now) }
  assert.deepEqual(passed, [0, 0.016, 0.1])
  stop()
  assert.equal(waiting.size, 0)
})

test("a camera that is removed hears nothing and sends nothing", async () => {
  const element = Object.assign(new EventTarget(), {clientHeight: 100})
  const told = []
  const hears = ["changed", "rested", "clicked", "hovered", "chosen"]
  const tell = Object.fromEntries(hears.map((name) => [name, () => told.push(name)]))
  const orbit = new Orbit(element, tell)
  element.dispatchEvent(new Event("dblclick"))
  assert.deepEqual(told, ["changed"])
  orbit.remove()
  element.dispatchEvent(new Event("dblclick"))
  await new Promise((done) => setTimeout(done, 5))
  assert.deepEqual(told, ["changed"])
})

test("an upload and a connection forget who listened", () => {
  const listeners = new Set()
  const model = {on: (_, act) => listeners.add(act), off: (_, act) => listeners.delete(act)}
  new Uploader(model, {ended: () => {}}).remove()
  assert.equal(listeners.size, 0)
  let lost = 0
  const page = {on_event: (_, act) => listeners.add(act)}
  globalThis.Bokeh = {documents: [page], Models: new Map()}
  const forget = onConnectionLost(() => { lost += 1 })
  for (const act of listeners) { act() }
  forget()
  for (const act of listeners) { act() }
  assert.equal(lost, 1)
})
