import assert from "node:assert/strict"
import {test} from "node:test"

import {lengthText, percentText, weightText} from "../../../../app/frontend/common/text.js"

test("lengths have three significant digits and no exponent", () => {
  const expected = [
    [0, "0"], [81.804, "81.8"], [0.012345, "0.0123"], [1234.5, "1235"], [-2.5, "-2.5"],
  ]
  for (const [length, text] of expected) { assert.equal(lengthText(length), text) }
  for (let k = -12; k < 12; k++) { assert.doesNotMatch(lengthText(5.73874 * 10 ** k), /e/) }
})

test("weights and parts are rounded alike", () => {
  assert.equal(weightText(0.125), "0.13")
  assert.equal(percentText(0), "0%")
  assert.equal(percentText(1e-5), "<0.1%")
  assert.equal(percentText(0.034), "3.4%")
  assert.equal(percentText(0.5), "50%")
})
