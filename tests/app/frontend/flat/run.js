// Prints what the browser computes of flat sections: `node run.js DATA.json`.

import {readFileSync} from "node:fs"

import {FlatDrawing} from "../../../../app/frontend/flat/draw.js"
import {FlatPlace} from "../../../../app/frontend/flat/place.js"
import {MODES} from "../../../../app/frontend/flat/modes.js"
import {
  inFront, isKept, pieceAt, Search, sumAt, ties,
} from "../../../../app/frontend/flat/search.js"

class Box {
  constructor(x, y, width, height) {
    const [right, bottom] = [x + width, y + height]
    Object.assign(this, {x, y, width, height, left: x, top: y, right, bottom})
  }
}
globalThis.DOMRect = Box
globalThis.innerWidth = 390

// A canvas that only knows how wide texts are; it notes them, with the letters' size.
function paper() {
  const texts = []
  const rest = () => {}
  const context = {
    font: "", measureText: (text) => ({width: 0.55 * size() * text.length}),
    fillText: (text, x, y) => texts.push([text, x, y, size(), context.measureText(text).width]),
  }
  const size = () => Number(context.font.match(/([\d.]+)px/)[1])
  return {texts, context: new Proxy(context, {get: (all, name) => all[name] ?? rest})}
}

// The texts of each mode at some sizes of the canvas.
function written(data) {
  const table = Array.from({length: 16}, () => "#000")
  const colors = {ink: "#000", paper: "#fff", distance: table, winding: table, negative: "#00f"}
  return Object.entries(MODES).flatMap(([mode, Mode]) =>
    [[900, 700, 1], [374, 180, 1], [1300, 600, 24 / 14]].map(([width, height, zoom]) => {
      const {texts, context} = paper()
      const scene = {data, mode, colors, zoom, tau: data.tau, length: (one) => one.toPrecision(3)}
      const shown = new Mode(scene)
      shown.reveal?.()
      const place = new FlatPlace()
      place.fit(shown.seen(), new Box(8, 8, width - 16, height - 16))
      scene.pixel = (point) => place.pixel(point)
      new FlatDrawing(context, place).draw(scene, width, height, 1)
      return {mode, width, height, zoom, texts, marked: scene.marked ?? null}
    }))
}

// Where the mark is in sections that are shown one after the other.
function marks(sections) {
  const scene = {mode: "winding"}
  return sections.map((data) => {
    Object.assign(scene, {data, tau: data.tau})
    new MODES.winding(scene).seen()
    return {...scene.marked, winding: pieceAt(scene.ray, scene.at)[2]}
  })
}

const sections = JSON.parse(readFileSync(process.argv[2], "utf8"))
console.log(JSON.stringify(process.argv[3] === "marks" ? marks(sections) : sections.map((data) => {
  const search = new Search(data)
  const queues = [[...search.queue]]
  const isSmallest = []
  while (search.queue.length) {
    isSmallest.push(search.isNext(search.queue[0]))
    search.settle()
    queues.push([...search.queue])
  }
  const middle = ([low, high]) => (low + high) / 2
  return {
    sums: data.rays.map((ray) => ray.pieces.map((piece) => sumAt(ray, middle(piece)))),
    windings: data.rays.map((ray) => ray.pieces.map((piece) => pieceAt(ray, middle(piece))[2])),
    kept: data.rays.map(({pieces}) => pieces.map(([, , winding]) => isKept(winding, data.tau))),
    tied: [...ties(data)].map(([node, corners]) => [node, corners.map(([corner]) => corner)]),
    laidOut: [...ties(data)].map(([, tied]) => {
      const {corners, crossing} = inFront(data, tied)
      return corners.map(([x, y]) => Math.hypot(x - crossing[0], y - crossing[1]))
    }),
    order: search.order,
    distance: [...search.distance].map((one) => one === Infinity ? null : one),
    before: [...search.before],
    isNext: isSmallest.every(Boolean),
    queues,
    written: written(data),
  }
})))
