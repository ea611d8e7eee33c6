import assert from "node:assert/strict"
import {test} from "node:test"

import {renew} from "../../../../app/frontend/common/elements.js"

let focused = null

const control = (name = null, id = undefined) => ({
  getAttribute: () => name,
  dataset: {id},
  matches() { return focused === this },
  focus() { focused = this },
})

// What an element does of all that `renew` asks for: what is removed loses the focus.
const parent = {
  children: [],
  querySelectorAll() { return this.children },
  replaceChildren(...children) {
    if (this.children.includes(focused)) { focused = null }
    this.children = children
  },
}

function renewed(before, at, after) {
  parent.replaceChildren(...before)
  focused = before[at] ?? null
  renew(parent, ...after)
  return after.indexOf(focused)
}

test("the focus follows a name, wherever it is now", () => {
  const after = [control("y"), control("x")]
  assert.equal(renewed([control("x"), control("y")], 1, after), 0)
  assert.equal(renewed([control("x"), control("y")], 1, [control("x")]), -1)
  assert.equal(renewed([control(null, "p")], 0, [control(null, "q"), control(null, "p")]), 1)
})

test("without names the focus keeps its place", () => {
  assert.equal(renewed([control(), control()], 1, [control(), control(), control()]), 1)
  assert.equal(renewed([control(), control()], 1, [control()]), -1)
  assert.equal(renewed([control()], -1, [control()]), -1)
})
