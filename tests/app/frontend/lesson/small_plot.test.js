import assert from "node:assert/strict"
import {test} from "node:test"

import {fractionText} from "../../../../app/frontend/lesson/small_plot.js"

test("parts of one are fractions where these are short", () => {
  const parts = [0, 0.25, 0.0625, 1 / 3, 1, 0.123, 1e-9]
  const texts = ["0", "¼", "1/16", "1/3", "1", "0.12", "0"]
  assert.deepEqual(parts.map(fractionText), texts)
})
