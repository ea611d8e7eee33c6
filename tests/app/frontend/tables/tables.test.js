import {click, modelOf, press, shown} from "../dom.js"

import assert from "node:assert/strict"
import {test} from "node:test"

import {render as curves} from "../../../../app/frontend/tables/curves.js"
import {render as histogram} from "../../../../app/frontend/tables/histogram.js"
import {render as methods} from "../../../../app/frontend/tables/methods.js"
import {render as rows} from "../../../../app/frontend/tables/rows.js"
import {render as table} from "../../../../app/frontend/tables/weights_table.js"

test("a list reports clicks and the row under the pointer, and keeps the focus", () => {
  const model = modelOf({
    label: "Pairs", rows: [["a", "1", 1], ["b", "2", 0.5]], chosen: -1, points: true,
  })
  const root = shown(rows, model)
  const [, second] = root.querySelectorAll("button")
  second.focus()
  click(second)
  assert.deepEqual(model.sent, [
    {type: "point-at-row", name: "b", nth: 0}, {type: "pick-row", name: "b", nth: 0},
  ])
  model.change({rows: [["a", "3", 1], ["b", "4", 0.5], ["c", "5", 0]], chosen: 1})
  assert.equal(document.activeElement, second)
  assert.equal(second.getAttribute("aria-current"), "true")
  assert.equal(second.querySelector("b").textContent, "4")
  model.change({rows: [["b", "6", 1], ["a", "3", 0.5], ["b", "5", 0]], chosen: 0})
  assert.ok(root.querySelector("button") === second, "the button moves with its row")
  model.sent.length = 0
  for (const one of root.querySelectorAll("button")) { click(one) }
  assert.deepEqual(model.sent.map(({name, nth}) => [name, nth]), [["b", 0], ["a", 0], ["b", 1]])
})

const METHOD = {
  title: "Euclidean", values: ["1", "2"], best: [true, false], note: "", state: "", chosen: false,
}

test("a table of methods reports boxes, and a note describes its box", () => {
  const model = modelOf({
    label: "Methods", heading: "Method", single: false, columns: [["L1", "error"], ["s", "time"]],
    rows: [{...METHOD, id: "x"}, {...METHOD, id: "y", note: "waits", state: "running"}],
  })
  const root = shown(methods, model)
  const [first, second] = root.querySelectorAll("input")
  first.focus()
  first.click()
  assert.deepEqual(model.sent, [{type: "show-method", id: "x", on: true}])
  const note = root.querySelector(`#${second.getAttribute("aria-describedby")}`)
  assert.equal(note.textContent, "waits")
  model.change({rows: [{...METHOD, id: "y"}, {...METHOD, id: "x", chosen: true}]})
  assert.equal(document.activeElement, first, "the focus follows the method")
  assert.ok(first.checked)
})

const CONTENT = {
  columns: [["Vertex", -1], ["hips", 4], ["file", -2]], rows: [[3, 0.25, 0], [7, 0, 1]],
  totals: [["Total", 0.25, 1]], order: [-1, false], pages: [1, 3],
}

test("a table sorts, turns pages, chooses and edits", () => {
  const model = modelOf({label: "Weights", content: CONTENT})
  const root = shown(table, model)
  const find = (name) => root.querySelector(`[name="${name}"]`)
  click(find("sort-4"))
  click(root.querySelector("[aria-label='Next page']"))
  click(find("row-7"))
  assert.deepEqual(model.sent.splice(0), [
    {type: "sort", column: 4}, {type: "page", page: 2}, {type: "pick-vertex", vertex: 7}])
  const cell = find("cell-3-4")
  for (const [text, sent] of [["0,5", [0.5]], ["2", []], ["x", []], ["", []]]) {
    cell.value = text
    cell.dispatchEvent(new Event("change"))
    assert.deepEqual(model.sent.splice(0).map(({value}) => value), sent)
  }
})

test("an edit is of the joint that it was written for, though its column moves", () => {
  const model = modelOf({label: "Weights", content: CONTENT})
  const root = shown(table, model)
  const cell = root.querySelector("[name='cell-3-4']")
  cell.focus()
  cell.value = "0.7"
  const columns = [["Vertex", -1], ["spine", 5], ["hips", 4]]
  model.change({content: {...CONTENT, columns, rows: [[3, 0.75, 0.25], [7, 1, 0]]}})
  assert.equal(document.activeElement, cell)
  cell.dispatchEvent(new Event("change"))
  assert.deepEqual(model.sent, [{type: "edit-weight", vertex: 3, joint: 4, value: 0.7}])
})

test("a cell follows its weight, but not over what is being written", () => {
  const model = modelOf({label: "Weights", content: CONTENT})
  const root = shown(table, model)
  const [cell, other] = root.querySelectorAll("input")
  cell.focus()
  cell.value = "0.7"
  model.change({content: {...CONTENT, rows: [[3, 0.3, 0], [7, 0.4, 1]]}})
  assert.equal(document.activeElement, cell)
  assert.equal(cell.value, "0.7")
  assert.equal(other.value, "0.400")
  press(cell, "Escape")
  assert.equal(cell.value, "0.300")
})

test("bars are chosen by keys, with Shift up to another one", () => {
  const model = modelOf({label: "Weights", bars: [["0 to 0.5", 3], ["0.5 to 1", 0]], chosen: []})
  const root = shown(histogram, model)
  const [first, second] = root.querySelectorAll("button")
  click(first)
  model.change({chosen: [0, 0]})
  click(second, {shiftKey: true})
  assert.deepEqual(model.sent.map((one) => [one.first, one.last]), [[0, 0], [0, 1]])
  assert.equal(first.getAttribute("aria-pressed"), "true")
  assert.equal(second.querySelector("i").style.height, "0%")
  model.change({bars: []})
  assert.ok(root.querySelector(".bars").hidden)
})

test("points of a curve say their value and are chosen by keys; the focus stays", () => {
  const point = (id, chosen) => ({id, title: id, text: "0.1", at: [0.5, 0.5], chosen})
  const plot = (chosen) => ({
    title: "L1", x_ticks: [[0, "0"]], y_ticks: [], curves: [
      {name: "any", points: [point("12", chosen), point("24", false)]}],
  })
  const model = modelOf({plots: [plot(false)]})
  const root = shown(curves, model)
  const [first] = root.querySelectorAll("[role=button]")
  first.focus()
  first.dispatchEvent(new Event("focus"))
  assert.equal(root.querySelector("figcaption .value").textContent, "12: 0.1")
  press(first, "Enter")
  assert.deepEqual(model.sent, [{type: "pick-point", id: "12"}])
  model.change({plots: [plot(true)]})
  assert.equal(root.querySelector("[role=button]"), first)
  assert.equal(first.getAttribute("aria-pressed"), "true")
})
