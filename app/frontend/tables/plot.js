// Curves in plots, and their names below them.

import {h, span} from "../common/nodes.js"

const DASHES = ["none", "6 3", "2 3", "8 3 2 3"]
const line = (number) =>
  ({class: `curve c${number}`, style: {strokeDasharray: DASHES[number % DASHES.length]}})

/** A curve through pixels. @param {number} number @param {number[][]} points */
export const curve = (number, points) =>
  h("path", {...line(number), d: `M${points.map((one) => one.join(" ")).join("L")}`})

/** The name of a curve, behind a piece of its line. @param {number} number @param {string} name */
export const sample = (number, name) => span("name",
  h("svg", {viewBox: "0 0 24 6", width: 24, height: 6}, h("path", {...line(number), d: "M0 3H24"})),
  name)
