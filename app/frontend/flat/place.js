// Where the points of a flat section are on the screen: flat, or on the way into the 3D scene.

import {along} from "../common/vectors.js"

export class FlatPlace {
  constructor() {
    this.scale = 1
    this.x = this.y = 0
    this.tilt = 0  // 1: as the camera of the 3D scene sees the plane
    this.project = null
    this.free = new DOMRect()
    /** @type {Record<string, number[]>} */
    this.frame = {}  // of the plane in the 3D scene
  }

  /** @param {number[]} box what is to be seen @param {DOMRect} free */
  fit([x0, y0, x1, y1], free) {
    this.free = free
    this.scale = Math.max(Math.min(free.width / (x1 - x0), free.height / (y1 - y0)), 1)
    this.x = free.x + free.width / 2 - this.scale * (x0 + x1) / 2
    this.y = free.y + free.height / 2 + this.scale * (y0 + y1) / 2
  }

  /** @param {number[]} point @returns {[number, number]} */
  pixel([x, y]) {
    const [px, py] = [this.x + this.scale * x, this.y - this.scale * y]
    if (!this.tilt || !this.project) { return [px, py] }
    const {origin, right, up} = this.frame
    const [sx, sy] = this.project(along(origin, [x, right], [y, up])) ?? [px, py]
    return [px + this.tilt * (sx - px), py + this.tilt * (sy - py)]
  }

  /** The point under a pixel, while the section is flat. @param {number[]} pixel */
  at([px, py]) {
    return [(px - this.x) / this.scale, (this.y - py) / this.scale]
  }
}
