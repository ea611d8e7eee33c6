// The search in a flat section: nodes are settled one by one, or predicted. See `modes.js`.

import {around, closer, CLICK_RADIUS} from "./part.js"
import {Search} from "./search.js"

const FIRST_RATE = 4  // nodes settled in the first second
const KINDS = ["mesh vertex", "lattice point", "crossing"]

export class Paths {
  constructor(scene) {
    this.scene = scene
    const whole = new Search(scene.data)
    while (whole.queue.length) { whole.settle() }
    this.count = whole.order.length
    scene.farthest = Math.max(...[...whole.distance].filter(Number.isFinite), 1e-9)
    scene.search = new Search(scene.data)
    scene.hidden = false
    scene.candidate = -1  // by keys, while a step asks
    this.isNear = true
    this.right = this.of = 0  // predictions
    this.restart()
  }

  seen() {
    const {data: {sources}} = this.scene
    const [middle] = sources[Math.floor(sources.length / 2)] ?? [-1]
    return around(this.scene, middle, this.isNear)
  }

  restart() {
    this.scene.search.restart()
    this.playing = false
    this.verdict = ""
    this.right = this.of = 0  // predictions
    this.scene.last = -1
  }

  step() {
    this.verdict = ""
    this.scene.last = this.scene.search.settle() ?? this.scene.last
    if (!this.scene.search.queue.length) { this.playing = false }
  }

  play() {
    if (!this.scene.search.queue.length) { this.restart() }
    this.playing = !this.playing
    this.isNear &&= !this.playing
    this.since = null
  }

  // Faster and faster: the first nodes one by one, then a wave.
  tick(now) {
    if (!this.playing) { return false }
    const {search} = this.scene
    this.since ??= now
    const due = (now - this.since) / 1000 * (FIRST_RATE + search.order.length / 3)
    for (let k = 0; k < Math.floor(due) && this.playing; k++) { this.step() }
    if (due >= 1) { this.since = now }
    return this.playing
  }

  press(point, isNew) {
    if (!isNew || this.playing) { return }
    const {data, nearest} = this.scene
    const node = nearest(point, data.nodes.keys(), CLICK_RADIUS)
    if (node >= 0) { this.predict(node) }
  }

  // A person says that a node is the next.
  predict(node) {
    const {search, data, length} = this.scene
    const kind = KINDS[data.kinds[node]]
    const tentative = length(search.distance[node])
    this.scene.candidate = -1
    if (search.isSettled[node]) {
      this.verdict = `This ${kind} is settled. Its distance ${tentative} is final.`
    } else if (search.distance[node] === Infinity) {
      this.verdict = `The queue does not hold this ${kind}.`
    } else {
      this.of += 1
      const isRight = search.isNext(node)
      const least = length(search.distance[search.queue[0]])
      if (isRight) {
        search.queue.splice(search.queue.indexOf(node), 1)
        search.queue.unshift(node)
        this.step()
        this.right += 1
      }
      this.verdict = isRight ? `Right: no other node of the queue is nearer than ${tentative}.`
        : `No: this one has ${tentative}, another one ${least}.`
      this.scene.answer(isRight ? "the nearest" : "a farther one")
    }
  }

  key(name) {
    if (this.scene.asking) { return this.choose(name) }
    if (name === " ") { this.play(); return true }
    if (name !== "Enter" && name !== "ArrowRight") { return false }
    this.step()
    return true
  }

  // Walks over the queue by keys, in the order of the nodes.
  choose(name) {
    const {scene, scene: {candidate, search: {queue}}} = this
    const by = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[name]
    if (name === "Enter" && candidate >= 0) { this.predict(candidate); return true }
    if (!by || !queue.length) { return false }
    const nodes = queue.toSorted((a, b) => a - b)
    scene.candidate = nodes.at((nodes.indexOf(candidate) + by) % nodes.length)
    return true
  }

  buttons() {
    const {scene} = this
    if (scene.asking) { return [closer(this)] }
    return [["Settle next", () => this.step()],
      [this.playing ? "Pause" : "Play", () => this.play()],
      ["Restart", () => this.restart()], closer(this),
      [scene.hidden ? "Show queue" : "Hide queue", () => { scene.hidden = !scene.hidden }]]
  }

  say() {
    const {data, search} = this.scene
    if (!data.sources.length) {
      return "The search needs a bone. Choose one that deforms the mesh."
    }
    if (this.playing) { return "" }  // too fast to read
    const {asking, candidate, length} = this.scene
    if (asking) {
      return `The queue holds ${search.queue.length} nodes, from ${data.bone || "the bone"}.`
        + (candidate < 0 ? "" : ` Marked: ${length(search.distance[candidate])}.`)
    }
    const {length: settled} = search.order
    const score = this.of ? ` ${this.right} of ${this.of} predicted.` : ""
    const rest = data.nodes.length - this.count
    const end = search.queue.length ? "Which node is settled next?"
      : `The queue is empty.${rest ? ` No path in this plane leads to ${rest} nodes.` : ""}`
    const done = `${settled} of ${this.count} nodes are settled, from ${data.bone || "the bone"}.`
    return `${this.verdict} ${done} ${end}${score}`.trim()
  }

  // The first nodes of the queue and their tentative distances.
  queued(count) {
    const {data, search, hidden, length} = this.scene
    if (hidden) { return [] }
    return search.queue.slice(0, count).map((node) =>
      `${["●", "■", "▲"][data.kinds[node]]} ${length(search.distance[node])}`)
  }
}
