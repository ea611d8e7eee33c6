// A short list of things that can be chosen, each with a number and a bar.

import {stylesheet} from "./styles.js"

const styled = await stylesheet("rows.css")

export function render({model}) {
  const list = document.createElement("ol")
  const fill = () => {
    const held = [...list.querySelectorAll("button")].findIndex((button) => button.matches(":focus"))
    list.setAttribute("aria-label", model.label)
    list.replaceChildren(...model.rows.map(([name, note, part], row) => {
      const item = document.createElement("li")
      const button = item.appendChild(document.createElement("button"))
      button.type = "button"
      const bar = document.createElement("i")
      bar.style.width = `${100 * part}%`
      const [text, value] = [document.createElement("span"), document.createElement("b")]
      text.textContent = text.title = name
      value.textContent = note
      button.append(text, value, bar)
      button.addEventListener("click", () => model.send_msg({row}))
      return item
    }))
    mark()
    list.querySelectorAll("button")[held]?.focus()
  }
  const mark = () => list.querySelectorAll("button").forEach((button, row) => {
    button.setAttribute("aria-current", row === model.chosen)
  })
  model.on("rows", fill)
  model.on("chosen", mark)
  fill()
  const root = document.createElement("div")
  root.append(styled(), list)
  return root
}
