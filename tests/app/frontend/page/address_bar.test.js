// The address changes at most twice a second, and what is shown last is what it says in the end.

import assert from "node:assert/strict"
import {test} from "node:test"

import {AddressBar} from "../../../../app/frontend/page/address_bar.js"

function browser({refuses = false} = {}) {
  const entries = ["/"]
  const timers = []
  const location = {pathname: "/", search: ""}
  const set = (address) => {
    if (refuses) { throw new Error("too many calls") }
    location.search = address.slice(1)
  }
  const history = {
    state: null,
    pushState: (state, title, address) => { set(address); entries.push(address) },
    replaceState: (state, title, address) => {
      set(address)
      entries[entries.length - 1] = address
    },
  }
  const setTimeout = (act) => timers.push(act)
  const clearTimeout = (id) => { if (id) { timers[id - 1] = () => {} } }
  return {entries, timers, bar: new AddressBar({history, location, setTimeout, clearTimeout})}
}

test("a dragged handle changes the address once, then to its last value", () => {
  const {entries, timers, bar} = browser()
  for (let x = 0; x < 50; x++) { bar.put(`?rig=a&cut=${x}`) }
  assert.deepEqual(entries, ["/?rig=a&cut=0"])
  timers.shift()()
  assert.deepEqual(entries, ["/?rig=a&cut=49"])
})

test("the entry that is left keeps its last choices", () => {
  const {entries, bar} = browser()
  for (const address of ["?rig=a", "?rig=a&x=1", "?rig=a&x=2", "?rig=b"]) { bar.put(address) }
  assert.deepEqual(entries, ["/?rig=a&x=2", "/?rig=b"])
})

test("another character and another step are entries of their own, at once", () => {
  const {entries, bar} = browser()
  const addresses = ["?rig=a", "?rig=a&x=1", "?rig=b", "?rig=b&step=2", "?rig=b&step=3"]
  for (const address of addresses) { bar.put(address) }
  assert.deepEqual(entries.slice(1), ["/?rig=b", "/?rig=b&step=2", "/?rig=b&step=3"])
})

test("a browser that refuses does no harm", () => {
  const {bar, timers} = browser({refuses: true})
  bar.put("?rig=a")
  timers.shift()()
  bar.put("?rig=b")
})
