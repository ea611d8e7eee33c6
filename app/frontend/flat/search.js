// Rays and the search of a flat section (`viewers/flat.py`): numbers alone, without a picture.

/** @typedef {{way: number, at: number, pieces: number[][], crossings: number[][]}} Ray */

/** The winding number at a place of a ray: entries count +1, exits −1. @param {Ray} ray */
export function sumAt({crossings}, at) {
  return crossings.reduce((sum, [place, step]) => place < at ? sum + step : sum, 0)
}

/** Whether a piece is inside: its winding number is at least tau. */
export const isKept = (winding, tau) => winding >= tau

/** The piece of a ray at a place, [low, high, winding number]. @param {Ray} ray */
export function pieceAt({pieces}, at) {
  return pieces.find(([low, high]) => low <= at && at <= high)
}

/** Pieces of equal numbers, or texts, that follow each other, as one. @param {Ray} ray */
export function runs({pieces, crossings}, textOf = (piece) => piece[2]) {
  const joined = []
  for (const [low, high, winding] of pieces) {
    const last = joined.at(-1)
    const isCrossed = crossings.some(([place]) => place === low)
    const isEqual = last && last[1] === low && textOf(last) === textOf([low, high, winding])
    if (isEqual && !isCrossed) {
      last[1] = high
    } else {
      joined.push([low, high, winding])
    }
  }
  return joined
}

/** The corners that each crossing is tied to, by its node. */
export function ties({edges, edgeKinds}) {
  const tied = new Map()
  edges.forEach(([crossing, corner], e) => {
    if (edgeKinds[e] !== 2) { return }
    if (!tied.has(crossing)) { tied.set(crossing, []) }
    tied.get(crossing).push([corner, e])
  })
  return tied
}

/**
 * A triangle in its own plane, in a square of side 1, and the crossing on it: laid out by the
 * lengths of sides and ties. Null where all corners are one point.
 */
export function inFront({edges, edgeKinds, lengths}, tied) {
  const corners = tied.map(([corner]) => corner)
  const side = (a, b) => lengths[edges.findIndex(([one, other], e) =>
    edgeKinds[e] === 0 && (one === a ? other === b : one === b && other === a))]
  const [ab, ac, bc] = [[0, 1], [0, 2], [1, 2]].map(([i, j]) => side(corners[i], corners[j]))
  const [pa, pb, pc] = tied.map(([, e]) => lengths[e])
  const along = (a, b) => (a * a - b * b + ab * ab) / (2 * ab)
  const above = (a, x) => Math.sqrt(Math.max(a * a - x * x, 0))
  const third = [along(ac, bc), above(ac, along(ac, bc))]
  const x = along(pa, pb)
  const y = above(pa, x)
  const misses = (sign) => Math.abs(Math.hypot(third[0] - x, third[1] - sign * y) - pc)
  const points = [[0, 0], [ab, 0], third, [x, misses(1) <= misses(-1) ? y : -y]]
  const low = [0, 1].map((i) => Math.min(...points.slice(0, 3).map((one) => one[i])))
  const high = [0, 1].map((i) => Math.max(...points.slice(0, 3).map((one) => one[i])))
  const size = Math.max(high[0] - low[0], high[1] - low[1])
  if (!(size > 0)) { return null }
  const placed = points.map((one) =>
    one.map((value, i) => 0.5 + (value - (low[i] + high[i]) / 2) / size))
  return {corners: placed.slice(0, 3), crossing: placed[3]}
}

// Dijkstra's algorithm, a node at a time.
export class Search {
  constructor({nodes, edges, lengths, sources}) {
    this.sources = sources
    this.queue = []  // nodes with tentative distances, the smallest first
    this.order = []  // settled nodes
    this.distance = new Float64Array(nodes.length)  // tentative until a node is settled
    this.before = new Int32Array(nodes.length)
    this.isSettled = new Uint8Array(nodes.length)
    this.near = nodes.map(() => [])
    edges.forEach(([a, b], e) => {
      this.near[a].push([b, lengths[e]])
      this.near[b].push([a, lengths[e]])
    })
    this.restart()
  }

  restart() {
    this.distance.fill(Infinity)
    this.before.fill(-1)
    this.isSettled.fill(0)
    this.order = []
    this.queue = []
    for (const [node, offset] of this.sources) { this.offer(node, offset, -1) }
  }

  // Settles the first node of the queue, and offers its neighbours a path through it.
  settle() {
    const node = this.queue.shift()
    if (node === undefined) { return node }
    this.isSettled[node] = 1
    this.order.push(node)
    for (const [next, length] of this.near[node]) {
      this.offer(next, this.distance[node] + length, node)
    }
    return node
  }

  offer(node, distance, before) {
    if (!(distance < this.distance[node])) { return }
    if (this.distance[node] < Infinity) { this.queue.splice(this.place(node), 1) }
    this.distance[node] = distance
    this.before[node] = before
    this.queue.splice(this.place(node), 0, node)
  }

  // Where a node is in the queue, or belongs: equal distances are in the order of the nodes.
  place(node) {
    let [low, high] = [0, this.queue.length]
    while (low < high) {
      const middle = (low + high) >> 1
      const other = this.queue[middle]
      const away = this.distance[other] - this.distance[node]
      if (away < 0 || (away === 0 && other < node)) { low = middle + 1 } else { high = middle }
    }
    return low
  }

  // Whether a node may be settled next: no other is nearer.
  isNext(node) {
    const first = this.queue[0]
    return first !== undefined && !this.isSettled[node]
      && this.distance[node] <= this.distance[first] * (1 + 1e-12)
  }
}
