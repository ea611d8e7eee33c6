import {click, modelOf, press, shown} from "../dom.js"

import assert from "node:assert/strict"
import {test} from "node:test"

import {render as inspector} from "../../../../app/frontend/widgets/inspector.js"
import {render as tree} from "../../../../app/frontend/widgets/joint_tree.js"
import {render as tabs} from "../../../../app/frontend/widgets/tabs.js"

const BONE = {
  joint: 1, name: "hips", short: null, color: "#123456", ours: 0.75, artist: 0.5, distance: 2,
  straight: 1, path: [["mesh edge", 1], ["outside", 1]], steps: [["raw", 1], ["kept", 0.75]],
  file: 0.5, factors: [], effective: 2, absence: "", rank: 0, chosen: false, weight: 0.75,
}
const FACTS = {
  vertex: 3, method: "", computed: true, overruled: false, artist: true, unit: "m", reached: true,
  component: {number: 1, of: 2, vertices: 8}, weights: [BONE], distances: [BONE], explain: true,
  why: [BONE], offered: [BONE, {...BONE, joint: 2, name: "spine", weight: 0.25}],
}

test("a card reports what is pressed", () => {
  const model = modelOf({facts: FACTS})
  const root = shown(inspector, model)
  for (const name of [".row", ".part", ".why", ".close"]) { click(root.querySelector(name)) }
  press(document, "Escape")
  root.querySelector("form").dispatchEvent(new Event("submit", {cancelable: true}))
  assert.deepEqual(model.sent, [
    {type: "pick", joint: 1}, {type: "show-part"}, {type: "explain"}, {type: "close"},
    {type: "close"}, {type: "override", weights: [[1, 0.75], [2, 0.25]]},
  ])
  model.change({facts: null})
  assert.equal(root.querySelector(".vertex-card"), null)
})

test("a box keeps its focus and what is being written when its card changes", () => {
  const model = modelOf({facts: FACTS})
  const root = shown(inspector, model)
  const [first, second] = root.querySelectorAll("input")
  first.focus()
  first.value = "0.5"
  const offered = [{...BONE, joint: 2, name: "spine", weight: 0.7}, {...BONE, weight: 0.3}]
  model.change({facts: {...FACTS, overruled: true, offered}})
  assert.equal(document.activeElement, first)
  assert.deepEqual([first.value, second.value], ["0.5", "0.7"])
  assert.deepEqual([...root.querySelectorAll("input")], [first, second], "boxes stay in place")
  model.change({facts: {...FACTS, vertex: 4}})
  assert.notEqual(root.querySelector("input"), first, "the card of another vertex is another one")
})

test("a card of a node leads to its neighbours", () => {
  const model = modelOf({facts: {
    node: 7, unit: "m", kind: "surface", position: [0, 1, 2], winding: 1, degree: 1,
    neighbours: [{node: 9, kind: "mesh", length: 0.5}], triangle: [4, 1, 2, 3], vertices: [],
  }})
  const root = shown(inspector, model)
  click(root.querySelector(".step"))
  assert.deepEqual(model.sent, [{type: "pick-node", node: 9}])
  assert.match(root.textContent, /face 4: 1, 2, 3/)
})

const joint = (number, level, more = {}) => ({
  joint: number, level, name: `joint ${number}`, short: `joint ${number}`, why: "",
  color: "#123456", control: false, locked: false, gain: 1, ours: 0.5, file: null, carries: true,
  changed: false, doubtful: false, ...more,
})

test("arrows walk in the tree of joints, open and close it; the focus stays", () => {
  const joints = [joint(0, 0), joint(1, 1), joint(2, 2), joint(3, 1)]
  const model = modelOf({rows: joints, chosen: 0})
  const root = shown(tree, model)
  const focused = () => Number(document.activeElement.dataset.joint)
  const listed = () =>
    [...root.querySelectorAll("[role=treeitem]")].map((one) => one.dataset.joint)
  root.querySelector("[tabindex='0']").focus()
  const at = []
  const keys = ["ArrowDown", "ArrowLeft", "ArrowDown", "Home", "End", "ArrowUp", "ArrowRight"]
  for (const key of keys) {
    press(document.activeElement, key)
    at.push(focused())
  }
  assert.deepEqual(at, [1, 1, 3, 0, 3, 1, 1])
  press(document.activeElement, "ArrowLeft")
  assert.deepEqual(listed(), ["0", "1", "3"])
  press(document.activeElement, " ")
  press(document.activeElement, "Enter")
  assert.deepEqual(model.sent, [{type: "carry", joint: 1, on: false}, {type: "pick", joint: 1}])
  const before = document.activeElement
  model.change({rows: joints.map((one) => ({...one, carries: one.joint !== 1}))})
  assert.equal(document.activeElement, before)
  assert.equal(before.getAttribute("aria-checked"), "false")
  model.change({chosen: 2})
  assert.deepEqual(listed(), ["0", "1", "2", "3"])
  assert.equal(document.activeElement, before)
})

test("doubtful joints come first, the largest at the top", () => {
  const model = modelOf({chosen: -1, rows: [
    joint(0, 0), joint(1, 1, {doubtful: true, ours: 0.1}), joint(2, 1, {doubtful: true})]})
  const root = shown(tree, model)
  const boxes = [...root.querySelectorAll("[role=switch]")]
  assert.deepEqual(boxes.map((one) => one.getAttribute("aria-label")),
    ["joint 2 deforms the mesh", "joint 1 deforms the mesh"])
  boxes[0].click()
  assert.deepEqual(model.sent, [{type: "carry", joint: 2, on: false}])
})

test("arrows walk along tabs, round the ends", () => {
  const model = modelOf({value: "a", label: "Panels", tabs: [["a", "A", ""], ["b", "B", ""]]})
  const root = shown(tabs, model)
  const seen = []
  const follow = () => model.change({value: model.value})
  for (const key of ["ArrowRight", "ArrowRight", "ArrowLeft", "Home", "End"]) {
    press(root.querySelector("[tabindex='0']"), key)
    seen.push(model.value)
    follow()
  }
  assert.deepEqual(seen, ["b", "a", "b", "a", "b"])
  assert.equal(document.activeElement.textContent, "B")
  assert.equal(root.querySelectorAll("[aria-selected=true]").length, 1)
})
