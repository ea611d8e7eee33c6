// Prints what the browser computes of flat sections: `node flat_run.js DATA.json`.

import {readFileSync} from "node:fs"

import {inFront, isKept, pieceAt, Search, sumAt, ties} from "../../../app/frontend/flat_search.js"

const sections = JSON.parse(readFileSync(process.argv[2], "utf8"))
console.log(JSON.stringify(sections.map((data) => {
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
  }
})))
