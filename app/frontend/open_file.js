// A button that opens a small text file.

import {stylesheet} from "./styles.js"

const styled = await stylesheet("open_file.css")

export function render({model}) {
  const button = document.createElement("button")
  button.type = "button"
  button.textContent = model.label
  button.addEventListener("click", () => {
    const input = document.createElement("input")
    Object.assign(input, {type: "file", accept: model.accept})
    input.addEventListener("change", async () => {
      const [file] = input.files
      if (!file) { return }
      // What is too large to be one is no such file, and its first letters say so, too.
      const text = await file.slice(0, model.most).text()
      model.send_msg({text})
    })
    input.click()
  })
  const root = document.createElement("div")
  root.append(styled(), button)
  return root
}
