// The score of an answer: whether it is right, and a sentence about it.

import {lengthText} from "../common/text.js"

/**
 * Returns null where nothing is right or wrong, as where a person only tries something.
 * @param {Answer} answer what the step asks for  @param {any} value what a person answered
 * @param {Record<string, number>} scores agreement of what was painted with methods
 * @returns {{right: boolean, text: string} | null}
 */
export function judge(answer, value, scores = {}) {
  if (value === "" || value === null || value === undefined) { return null }
  const {kind, expected, tolerance = 0, unit = ""} = answer
  if (kind === "number") {
    const right = Math.abs(value - expected) <= tolerance
    const measured = `Measured: ${lengthText(expected)}${unit && ` ${unit}`}.`
    return {right, text: `You said ${lengthText(Number(value))}. ${measured}`}
  }
  if (kind === "paint" && typeof value === "number") {
    const to = (part, name) => `to ${Math.round(100 * part)}% with ${name}`
    const others = Object.entries(scores).map(([name, part]) => `, ${to(part, `“${name}”`)}`)
    const text = `Your paint agrees ${to(value, "what should follow")}${others.join("")}.`
    return {right: value >= expected, text}
  }
  if (kind === "paint" || expected === undefined) { return null }
  const all = [expected].flat()
  const right = all.includes(value)
  return {right, text: right ? `Right: ${value}.` : `You chose ${value}, not ${all[0]}.`}
}

/** How many of the answers are right, and how many have a score. @param {Step[]} steps */
export function total(steps, answers) {
  const scores = steps.map(({answer}, i) => judge(answer, answers[i]))
    .filter((score) => score !== null)
  return {right: scores.filter(({right}) => right).length, of: scores.length}
}
