// Draws a flat section on a canvas. Kinds of nodes and edges differ by shape as well as by colour.

/** @typedef {import("./place.js").FlatPlace} FlatPlace */

import {inFront, isKept, runs, sumAt} from "./search.js"

export const CORNERS = ["A", "B", "C"]
const FAINT = 0.16
const SHOWN_NUMBERS = 10  // of the queue
const WINDINGS = 11  // colours of winding numbers from 0 to 1
const LETTERS = 14  // pixels
const ROUNDS = 4  // of places for a text, each farther away
const AROUND = [[1, -1], [1, 1], [-1, -1], [-1, 1], [0, -1], [0, 1], [1, 0], [-1, 0]]

export class FlatDrawing {
  /** @param {CanvasRenderingContext2D} context @param {FlatPlace} place */
  constructor(context, place) {
    this.context = context
    this.place = place
    /** @type {Record<string, any>} */
    this.scene = {}
    this.colors = {}
    this.unit = 1
    /** @type {number[][]} */
    this.taken = []  // by texts and the mark: boxes of pixels
  }

  /** @param {Record<string, any>} scene what is shown: see `scene.js` */
  draw(scene, width, height, ratio) {
    const {context: c} = this
    this.scene = scene
    this.colors = scene.colors
    this.unit = Math.max(Math.min(this.place.scale / scene.data.resolution / 10, 2.4), 0.55)
    c.setTransform(ratio, 0, 0, ratio, 0, 0)
    c.clearRect(0, 0, width, height)
    c.lineCap = "round"
    c.textBaseline = "middle"
    c.textAlign = "center"
    c.font = `600 ${LETTERS * scene.zoom}px Roboto, system-ui, sans-serif`
    this.taken = []
    this.lines(scene.data.outline, this.colors.ink, 1.4)
    this[scene.mode]()
  }

  // Segments [x0, y0, x1, y1] of the section.
  lines(segments, color, width, how = {}) {
    const {place} = this
    this.paths(segments.map(([x0, y0, x1, y1]) =>
      [place.pixel([x0, y0]), place.pixel([x1, y1])]), color, width, how)
  }

  /**
   * Segments between pixels as one path.
   * @param {any[]} segments @param {string} color @param {number} width
   * @param {{alpha?: number, dash?: number[]}} [how]
   */
  paths(segments, color, width, {alpha = 1, dash = []} = {}) {
    const {context: c} = this
    c.beginPath()
    for (const [[x0, y0], [x1, y1]] of segments) {
      c.moveTo(x0, y0)
      c.lineTo(x1, y1)
    }
    Object.assign(c, {strokeStyle: color, lineWidth: width, globalAlpha: alpha})
    c.setLineDash(dash)
    c.stroke()
    c.setLineDash([])
    c.globalAlpha = 1
  }

  // A part of a ray as a segment.
  part({way, at}, low, high) {
    return way ? [at, low, at, high] : [low, at, high, at]
  }

  // Writes a text beside a point, on the first of some sides where no other text is; farther away
  // with a line to the point, or not at all.
  /** @param {string} text @param {number[]} at @param {number[][]} sides */
  label(text, [x, y], sides, {gap = 4, color = this.colors.ink} = {}) {
    const {context: c, colors, scene, place: {free}} = this
    const [width, height] = [c.measureText(text).width + 6, 1.3 * LETTERS * scene.zoom]
    const places = Array.from({length: ROUNDS}, (_, round) => sides.map(([right, down]) =>
      [right, down].map((side, i) => side * ([width, height][i] / 2 + gap + round * height))))
    for (const [i, [dx, dy]] of places.flat().entries()) {
      const box = [x + dx - width / 2, y + dy - height / 2, x + dx + width / 2, y + dy + height / 2]
      const isOutside = box[0] < free.left || box[2] > free.right
        || box[1] < free.top || box[3] > free.bottom
      if (isOutside || this.taken.some((other) => overlap(box, other))) { continue }
      this.taken.push(box)
      if (i >= sides.length) { this.paths([[[x, y], [x + dx, y + dy]]], color, 1, {alpha: 0.6}) }
      Object.assign(c, {strokeStyle: colors.paper, lineWidth: 5, lineJoin: "round"})
      c.strokeText(text, x + dx, y + dy)
      c.fillStyle = color
      c.fillText(text, x + dx, y + dy)
      return
    }
  }

  /** @param {number} kind @param {number[]} at */
  shape(kind, [x, y], radius, fill, stroke = null, width = 2) {
    const {context: c} = this
    c.beginPath()
    if (kind === 0) {
      c.arc(x, y, radius, 0, 7)
    } else if (kind === 1) {
      c.rect(x - 0.85 * radius, y - 0.85 * radius, 1.7 * radius, 1.7 * radius)
    } else {
      c.moveTo(x, y - 1.25 * radius)
      c.lineTo(x + 1.15 * radius, y + 0.8 * radius)
      c.lineTo(x - 1.15 * radius, y + 0.8 * radius)
      c.closePath()
    }
    if (fill) { c.fillStyle = fill; c.fill() }
    if (stroke) { Object.assign(c, {strokeStyle: stroke, lineWidth: width}); c.stroke() }
  }

  rays() {
    const {data, ray, lit, tau} = this.scene
    const {colors} = this
    const pieces = (rays, those) => rays.flatMap((one) =>
      one.pieces.filter(those).map(([low, high]) => this.part(one, low, high)))
    const along = data.rays.filter(({way}) => way === ray.way)
    this.lines(pieces(along, () => true), colors.ink, 1, {alpha: FAINT})
    const seen = data.rays.filter((one) => lit.has(one))
    const inside = ([, , winding]) => isKept(winding, tau)
    if (!this.scene.asking) { this.lines(pieces(seen, inside), colors.interior, 5 * this.unit) }
    this.chosenRay(([low, high]) => windingText(sumAt(ray, (low + high) / 2)))
  }

  winding() {
    const {data, ray, tau} = this.scene
    const {colors} = this
    const groups = new Map()
    for (const one of data.rays.filter(({way}) => way === ray.way)) {
      for (const [low, high, winding] of one.pieces) {
        const key = `${this.windingColor(winding)} ${Number(isKept(winding, tau))}`
        if (!groups.has(key)) { groups.set(key, []) }
        groups.get(key).push(this.part(one, low, high))
      }
    }
    for (const [key, segments] of groups) {
      const [color, isInside] = key.split(" ")
      const isWide = isInside === "1" || color === colors.negative
      this.lines(segments, color, (isWide ? 6 : 1.5) * this.unit)
    }
    this.chosenRay(([, , winding]) => windingText(winding, 1))
  }

  windingColor(winding) {
    if (winding <= -this.scene.tau) { return this.colors.negative }
    const at = Math.round(Math.min(Math.max(winding, 0), 1) * (WINDINGS - 1))
    return this.colors.winding[at]
  }

  // The chosen ray: its crossings with +1 and −1, and a number for each run between them.
  chosenRay(numberOf) {
    const {ray, at, tau, asking} = this.scene
    const {colors, place} = this
    const all = runs(ray, numberOf)
    const line = all.map(([low, high]) => this.part(ray, low, high))
    this.lines(line, colors.paper, 9)
    this.lines(line, colors.ink, 2)
    const inside = all.filter(([, , winding]) => !asking && isKept(winding, tau))
    this.lines(inside.map(([low, high]) => this.part(ray, low, high)), colors.interior, 6)
    const [x, y] = place.pixel(ray.way ? [ray.at, at] : [at, ray.at])
    const [above, below] = ray.way ? [[[1, 0]], [[-1, 0]]] : [[[0, -1]], [[0, 1]]]
    this.taken.push([x - 9, y - 9, x + 9, y + 9])
    for (const run of asking ? [] : all) {
      const middle = (run[0] + run[1]) / 2
      const pixel = place.pixel(ray.way ? [ray.at, middle] : [middle, ray.at])
      if (middle > ray.crossings[0]?.[0]) { this.label(numberOf(run), pixel, above, {gap: 8}) }
    }
    for (const [where, step] of ray.crossings) {
      const pixel = place.pixel(ray.way ? [ray.at, where] : [where, ray.at])
      this.shape(2, pixel, 4.5, step > 0 ? colors.surface : colors.paper, colors.surface)
      this.label(step > 0 ? "+1" : "−1", pixel, below, {gap: 8, color: colors.surface})
    }
    this.shape(0, [x, y], 7, colors.mark, colors.paper)
  }

  edges(kind, color, width, options = {}, those = (_e) => true) {
    const {data: {edges, edgeKinds, nodes}} = this.scene
    const chosen = edges.filter((_, e) => edgeKinds[e] === kind && those(e))
    this.lines(chosen.map(([a, b]) => [...nodes[a], ...nodes[b]]), color, width, options)
  }

  graph() {
    const {data, tied, joined, node} = this.scene
    const {colors, place, unit} = this
    const [mesh, interior, surface] = [colors.mesh, colors.interior, colors.surface]
    this.edges(0, mesh, 2.4)
    this.edges(1, interior, 2.2 * unit)
    const isJoined = (e) => joined.has(data.edges[e][0])
    this.edges(2, surface, 1.8, {dash: [4, 3]}, isJoined)
    const fills = [mesh, interior, surface]
    data.nodes.forEach((at, i) => {
      const kind = data.kinds[i]
      const isOpen = kind === 2 && !joined.has(i)
      const [fill, stroke] = isOpen ? [colors.paper, surface] : [fills[kind], null]
      this.shape(kind, place.pixel(at), [1.6, 2.2, 2.4][kind] * unit, fill, stroke, 1.5)
    })
    if (node >= 0) { this.lens(node, tied.get(node) ?? []) }
  }

  // The chosen crossing with its triangle; and the same as seen from in front of the triangle.
  lens(node, tied) {
    const {data: {nodes}, joined, asking, chosen} = this.scene
    const {place} = this
    const corners = tied.map(([corner]) => place.pixel(nodes[corner]))
    this.triangle(corners, place.pixel(nodes[node]), joined.has(node), 1)
    this.shape(0, place.pixel(nodes[node]), 14, null, this.colors.mark, 2.5)
    const {free} = place
    const size = Math.min(...asking ? [free.width, 0.6 * free.height, 300 * this.scene.zoom]
      : [0.6 * free.width, 0.5 * free.height, 220 * this.scene.zoom])
    const [left, top] = [free.left, free.bottom - size]
    const seen = inFront(this.scene.data, tied)
    if (!seen) { return }
    const {context: c, colors} = this
    Object.assign(c, {fillStyle: colors.paper, strokeStyle: colors.mark, lineWidth: 2})
    c.beginPath()
    c.rect(left, top, size, size)
    c.fill()
    c.stroke()
    /** @param {number[]} point */
    const inset = ([x, y]) => [left + size * (0.18 + 0.64 * x), top + size * (0.82 - 0.64 * y)]
    const ends = this.scene.inset = seen.corners.map(inset)
    this.triangle(ends, inset(seen.crossing), joined.has(node), 2)
    if (asking) {
      const ties = ends.filter((_, i) => chosen.has(i)).map((end) => [inset(seen.crossing), end])
      this.paths(ties, colors.surface, 4, {dash: [6, 4]})
      ends.forEach((end, i) =>
        this.label(CORNERS[i], end, [[0, end[1] < top + size / 2 ? -1 : 1]], {gap: 7}))
    }
    if (!joined.has(node)) { return }
    const [x, y] = inset(seen.crossing)
    tied.forEach(([, e], i) => {
      const [cx, cy] = inset(seen.corners[i])
      const at = [(x + 2 * cx) / 3, (y + 2 * cy) / 3]
      this.label(this.scene.length(this.scene.data.lengths[e]), at, [[0, 0], ...AROUND])
    })
  }

  triangle(corners, crossing, isJoined, size) {
    const {colors} = this
    this.paths(corners.map((one, i) => [one, corners[(i + 1) % 3]]), colors.mesh, 2 + size)
    if (isJoined) {
      const ties = corners.map((one) => [crossing, one])
      this.paths(ties, colors.surface, 2 + size, {dash: [6, 4]})
    }
    for (const one of corners) { this.shape(0, one, 3 + 2 * size, colors.mesh, colors.paper) }
    this.shape(2, crossing, 4 + 2 * size, colors.surface, colors.paper)
  }

  search() {
    const {data, search, farthest, last, candidate, hidden, length} = this.scene
    const {colors, place, unit} = this
    this.edges(0, colors.mesh, 1, {alpha: 0.5})
    this.edges(1, colors.interior, 1, {alpha: 0.4})
    this.edges(2, colors.surface, 1, {alpha: 0.4, dash: [3, 3]})
    this.lines(data.bones, colors.source, 5, {alpha: 0.55})
    const {distance, before, order, queue} = search
    const paths = order.filter((node) => before[node] >= 0)
    this.lines(paths.map((node) => [...data.nodes[before[node]], ...data.nodes[node]]),
      colors.ink, 1.6 * unit, {alpha: 0.65})
    data.nodes.forEach((at, i) => {
      const kind = data.kinds[i]
      if (search.isSettled[i]) {
        const color = this.distanceColor(distance[i] / farthest)
        this.shape(kind, place.pixel(at), 4 * unit, color, colors.ink, 0.7)
      } else {
        this.shape(kind, place.pixel(at), 2 * unit, colors.idle)
      }
    })
    for (const node of queue) {
      const pixel = place.pixel(data.nodes[node])
      this.shape(data.kinds[node], pixel, 4 * unit, colors.paper, colors.mark, 1.8)
    }
    for (const [node] of data.sources) {
      this.shape(0, place.pixel(data.nodes[node]), 7 * unit, null, colors.source, 2.5)
    }
    for (const node of hidden ? [] : queue.slice(0, SHOWN_NUMBERS)) {
      this.label(length(distance[node]), place.pixel(data.nodes[node]), AROUND)
    }
    for (const node of [last, candidate].filter((one) => one >= 0)) {
      this.shape(0, place.pixel(data.nodes[node]), 9, null, colors.mark, 3)
    }
  }

  distanceColor(part) {
    const {distance} = this.colors
    return distance[Math.min(Math.floor(part * distance.length), distance.length - 1)]
  }
}

/** @param {number[]} one @param {number[]} other */
const overlap = ([a, b, c, d], [e, f, g, h]) => a < g && e < c && b < h && f < d

/** A winding number: whole, or with one or two digits. */
export function windingText(winding, digits = 2) {
  const text = winding.toFixed(digits)
  return String(Number(text) % 1 ? text : Number(text) || 0).replace("-", "−")
}
