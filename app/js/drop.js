// A place in the sidebar to drop files on, or to choose them with a click.

const DROP_STYLE = `
:host { display: block; position: relative; }
label { display: block; box-sizing: border-box; width: 100%; padding: 7px 12px 8px; cursor: pointer;
  border: 1.5px dashed var(--mui-palette-divider, #8888); border-radius: 10px; text-align: center;
  font: 13px/1.4 Roboto, system-ui, sans-serif; color: var(--mui-palette-text-primary, #333);
  position: relative; overflow: hidden; transition: border-color .15s, background .15s; }
label:hover, label.over, label:focus-within { border-color: var(--mui-palette-primary-main, #147);
  background: color-mix(in srgb, var(--mui-palette-primary-main, #147) 7%, transparent); }
small { display: block; font-size: 11.5px; margin-top: 1px;
  color: var(--mui-palette-text-secondary, #777); }
button { all: unset; position: absolute; right: 8px; top: 8px; padding: 2px 8px; cursor: pointer;
  border-radius: 6px; font: 500 12px/1.6 Roboto, system-ui, sans-serif;
  color: var(--mui-palette-primary-main, #147); background: var(--mui-palette-background-paper, #fff); }
button:focus-visible { outline: 2px solid var(--mui-palette-primary-main, #147); }
button[hidden] { display: none; }
input { position: absolute; width: 1px; height: 1px; opacity: 0; }
i { position: absolute; left: 0; bottom: 0; height: 3px; width: 0;
  background: var(--mui-palette-primary-main, #147); transition: width .1s; }
`

export function render({model}) {
  const style = document.createElement("style")
  style.textContent = DROP_STYLE
  const label = document.createElement("label")
  const text = document.createElement("span")
  text.textContent = model.label
  const small = document.createElement("small")
  small.textContent = model.hint
  const input = document.createElement("input")
  input.type = "file"
  input.multiple = true
  input.setAttribute("aria-label", model.label)
  const bar = document.createElement("i")
  label.append(text, small, input, bar)
  const cancel = document.createElement("button")
  cancel.type = "button"
  cancel.textContent = "Cancel"
  cancel.hidden = true
  cancel.addEventListener("click", () => uploader.cancel())
  const uploader = new Uploader(model, {
    started: (files) => { text.textContent = `Sending ${files.map((f) => f.name).join(", ")}`
      cancel.hidden = false },
    moved: (part) => { bar.style.width = `${100 * part}%` },
    ended: () => { bar.style.width = "0"; input.value = ""; text.textContent = model.label
      cancel.hidden = true },
  })
  input.addEventListener("change", () => uploader.send(input.files))
  acceptDrops(label, (over) => label.classList.toggle("over", over), (f) => uploader.send(f))
  const root = document.createElement("div")
  root.append(style, label, cancel)
  return root
}
