// How several views divide a canvas, and what of it the cards over it leave free at first.

import {boxOf} from "../common/shape.js"
import {dot} from "../common/vectors.js"

const FRONT = [0.42, 0.16, 1]  // where one looks from at first, as in viewers/camera.py

// Views side by side fill the canvas, and each has a caption.
export function noCards(several) {
  return several ? {left: 0, right: 0, top: 0, bottom: 0} : {left: 0, right: 0, top: 20, bottom: 20}
}

// Width over height of a box as it is seen at first.
export function shapeOf(bounds) {
  const [aside, above, ahead] = FRONT
  const size = boxOf(bounds).size.map((length) => Math.max(length, 1e-9))
  const flat = Math.hypot(aside, ahead)
  const right = [ahead / flat, 0, aside / flat]
  const up = [aside * above / flat, flat, above * ahead / flat].map((x) => x / Math.hypot(...FRONT))
  return Math.min(Math.max(dot(right, size) / dot(up, size), 0.4), 2.5)
}

// Divides a canvas among views so that the contents of each, below its caption, are as large as
// can be.
export function tiles(count, width, height, shape, captions = 0) {
  let [best, columns] = [0, 1]
  for (let c = 1; c <= count; c++) {
    const seen = Math.min(width / c / shape, height / Math.ceil(count / c) - captions)
    if (seen > best) { [best, columns] = [seen, c] }
  }
  const rows = Math.ceil(count / columns)
  return Array.from({length: count}, (_, k) => {
    const [c, r] = [k % columns, Math.floor(k / columns)]
    const along = Math.min(columns, count - r * columns)  // the last row shares what it has
    return [width * c / along, height * r / rows, width / along, height / rows]
  })
}
