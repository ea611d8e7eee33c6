// Numbers as texts: each kind is rounded alike everywhere.

// Three significant digits, never with an exponent; whole numbers from 1000 on.
export function lengthText(length) {
  if (!Number.isFinite(length) || length === 0) { return length === 0 ? "0" : "–" }
  const size = Math.abs(length)
  if (size >= 1000) { return String(Math.round(length)) }
  const digits = Math.min(Math.max(2 - Math.floor(Math.log10(size)), 0), 6)
  const text = String(Number(Number(length.toPrecision(3)).toFixed(digits)))
  return text === "0" || text.includes("e") ? `${length < 0 ? "-" : ""}<0.00001` : text
}

export function weightText(weight) {
  return weight.toFixed(2)
}

export function percentText(part) {
  const percent = 100 * part
  if (percent === 0) { return "0%" }
  if (percent < 0.05) { return "<0.1%" }
  return `${percent.toFixed(percent < 9.95 ? 1 : 0)}%`
}
