// Rays through a flat section: crossings along one, and winding numbers. See `modes.js`.

import {closer} from "./part.js"
import {isKept, pieceAt, runs, sumAt} from "./search.js"
import {windingText} from "./draw.js"

const NEAR_HOLE = 0.3  // winding number
const REVERSED = -0.9
const SLIM = 700  // a window less wide than this shows a part
const PART = 0.3  // of the width, above the mark and below

const clamped = (x, low, high) => Math.min(Math.max(x, low), high)
const signed = (step) => step > 0 ? "+1" : "−1"

export class Rays {
  constructor(scene) {
    this.scene = scene
    this.ways = [0, 1].map((way) => scene.data.rays.filter((ray) => ray.way === way))
    scene.lit = new Set()
    this.index = this.ways.map((rays) => Math.floor(rays.length / 2))
    this.identity = `${scene.mode} ${scene.data.box}`  // alike where only signs of faces change
    const {of, way, point} = scene.marked ?? {}
    this.turn(this.ways[0].length ? 0 : 1)
    const isSame = of === this.identity
    if (isSame) { this.way = way; this.press(point) }
    if (!isSame && scene.mode === "winding") { this.findNotable() }
    this.isNear = innerWidth < SLIM
  }

  // Begins in the longest run where faces are reversed; else near a hole, where there is one.
  findNotable() {
    const all = this.ways[this.way].flatMap((ray, index) => runs(ray).map(([low, high, winding]) =>
      ({index, at: (low + high) / 2,
        rank: winding < REVERSED ? high - low : -Math.abs(winding - NEAR_HOLE)})))
    const best = all.reduce((one, other) => other.rank > one.rank ? other : one)
    if (best.rank > -NEAR_HOLE / 2) { this.choose(best.index, best.at) }
  }

  turn(way) {
    if (!this.ways[way].length) { return }
    this.way = way
    const all = runs(this.ways[way][this.index[way]])
    /** @param {number[]} piece */
    const isInside = ([, , winding]) => isKept(winding, this.scene.tau)
    const inside = (!this.scene.asking && all.find(isInside)) || all[0]
    this.choose(this.index[way], (inside[0] + inside[1]) / 2)
  }

  choose(index, at) {
    const rays = this.ways[this.way]
    const to = clamped(index, 0, rays.length - 1)
    const from = this.index[this.way]
    for (let i = Math.min(from, to); i <= Math.max(from, to); i++) { this.scene.lit.add(rays[i]) }
    this.index[this.way] = to
    const ray = this.scene.ray = rays[to]
    const along = this.scene.at = clamped(at, ray.pieces[0][0], ray.pieces.at(-1)[1])
    const point = this.way ? [ray.at, along] : [along, ray.at]
    this.scene.marked = {of: this.identity, way: this.way, point}
  }

  // The mark goes where the sum is right.
  reveal() {
    const {ray, at, tau} = this.scene
    if (!isKept(sumAt(ray, at), tau)) { this.turn(this.way) }
  }

  press(point) {
    const across = this.ways[this.way].map(({at}) => Math.abs(at - point[1 - this.way]))
    this.choose(across.indexOf(Math.min(...across)), point[this.way])
  }

  key(name) {
    const move = {
      ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    }[name]
    if (name === "Enter" && this.scene.asking) { this.answer(); return true }
    if (!move) { return false }
    const {ray, at} = this.scene
    const all = runs(ray)
    const now = all.findIndex(([, high]) => at <= high)
    const run = all[clamped(now + move[this.way], 0, all.length - 1)]
    const to = move[this.way] ? (run[0] + run[1]) / 2 : at
    this.choose(this.index[this.way] + move[1 - this.way], to)
    return true
  }

  buttons() {
    const {scene} = this
    const light = ["Light all", () => this.ways[this.way].forEach((ray) => scene.lit.add(ray))]
    if (scene.asking) { return [["This point", () => this.answer()], closer(this)] }
    const turn = ["Turn rays", () => this.turn(1 - this.way)]
    return [turn, ...scene.mode === "rays" ? [light] : [], closer(this)]
  }

  // All, or what is as high as the mark.
  seen() {
    const {data: {box, box: [x0, y0, x1, y1]}, marked} = this.scene
    this.middle = this.isNear ? this.middle ?? marked.point[1] : null
    if (!this.isNear) { return box }
    const half = Math.min(PART * (x1 - x0), (y1 - y0) / 2)
    const y = clamped(this.middle, y0 + half, y1 - half)
    return [x0, y - half, x1, y + half]
  }

  answer() {
    const {ray, at} = this.scene
    this.scene.answer(windingText(sumAt(ray, at)))
  }

  say() {
    const {ray, at, tau, mode, asking} = this.scene
    const [, , winding] = pieceAt(ray, at) ?? [0, 0, 0]
    const isInside = isKept(winding, tau)
    if (mode === "winding") {
      const pieces = this.ways[this.way].flatMap((one) => one.pieces)
      const count = pieces.filter(([, , number]) => isKept(number, tau)).length
      /** @param {number[]} piece */
      const textOf = ([, , number]) => windingText(number, 1)
      const along = runs(ray, textOf).map(textOf).join(", ")
      return `At the mark the winding number is ${windingText(winding)}, `
        + (isInside ? `at least τ = ${tau.toFixed(2)}: inside. `
          : `less than τ = ${tau.toFixed(2)}: outside. `)
        + `Along the ray: ${along}. ${count} of ${pieces.length} pieces are inside.`
    }
    const steps = ray.crossings.map(([, step]) => signed(step)).join(" ")
    if (asking) { return `Crossings from the left: ${steps || "none"}. The mark is movable.` }
    const sum = sumAt(ray, at)
    const differs = Math.abs(sum - winding) > 0.005
      ? ` Its winding number is ${windingText(winding)}: the surface has holes.` : ""
    return `Ray ${this.index[this.way] + 1} of ${this.ways[this.way].length}. `
      + `Crossings: ${steps || "none"}. Sum at the mark: ${windingText(sum)}, `
      + `${isInside ? "inside" : "outside"}.${differs}`
  }
}
