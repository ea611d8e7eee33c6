// Scores of answers.

import assert from "node:assert/strict"
import test from "node:test"

import {judge, total} from "../../../../app/frontend/lesson/score.js"

const number = {kind: "number", expected: 0.585, tolerance: 0.1, unit: "m"}

test("a number is right within its tolerance, and told beside the measured one", () => {
  assert.equal(judge(number, 0.5).right, true)
  assert.equal(judge(number, 0.48).right, false)
  assert.equal(judge(number, 0.5).text, "You said 0.5. Measured: 0.585 m.")
})

test("an option, and one of several joints", () => {
  const choice = {kind: "choice", options: ["A", "B"], expected: "B"}
  assert.deepEqual(judge(choice, "A"), {right: false, text: "You chose A, not B."})
  assert.equal(judge(choice, "B").right, true)
  assert.equal(judge({kind: "vertex", expected: ["hips", "thigh.L"]}, "thigh.L").right, true)
})

test("paint counts by its score; its options, where nobody can paint, do not", () => {
  const paint = {kind: "paint", expected: 0.7}
  const text = "Your paint agrees to 50% with what should follow."
  assert.deepEqual(judge(paint, 0.5), {right: false, text})
  const scores = {"Straight lines": 0.65, "Through the body": 0.8}
  assert.equal(judge(paint, 0.5, scores).text, "Your paint agrees to 50% with what should follow, "
  + "to 65% with “Straight lines”, to 80% with “Through the body”.")
  assert.equal(judge(paint, 0.71).right, true)
  assert.equal(judge(paint, "The arm"), null)
})

test("what nobody answered has no score", () => {
  for (const nothing of ["", null, undefined]) { assert.equal(judge(number, nothing), null) }
  assert.equal(judge({kind: "act"}, "Flip"), null)
  assert.equal(judge({kind: "choice", options: ["A", "B"]}, "A"), null)
  const steps = [{answer: number}, {answer: number}, {answer: {kind: "act"}}]
  assert.deepEqual(total(steps, {0: 0.6, 1: 3, 2: "x"}), {right: 1, of: 2})
  assert.deepEqual(total(steps, {1: ""}), {right: 0, of: 0})
})
