// The page's 3D view: drawn here where the browser has WebGL, else by the server.

import {element} from "../common/elements.js"
import {Overlay} from "./overlay.js"
import {PictureView} from "./picture_view.js"
import {probe} from "./probe.js"
import {loadVtk} from "../engine/renderer.js"
import {SceneView} from "./scene_view.js"
import {skipLink} from "../page/skip_link.js"
import {pageBefore, recall, rememberPage} from "../common/storage.js"
import {Surroundings} from "../page/surroundings.js"

// Tells the server what it must know of this browser before it sends anything.
function tellReady(model, pictures) {
  // What was chosen here before, else what the system prefers.
  const system = matchMedia("(prefers-color-scheme: dark)").matches ? "1" : null
  const dark = recall("cutcell dark") ?? system
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches
  const {innerWidth: width} = window
  model.send_msg({type: "ready", width, page: pageBefore, dark, calm, pictures})
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const root = element("div", {style: {display: "contents"}})
  let overlay, view, camera
  let gone = false
  const begin = (make) => {
    overlay = new Overlay()
    root.replaceChildren(overlay.root)
    view = make()
    tellReady(model, view instanceof PictureView)
  }
  const end = () => {
    view?.remove()
    if (window.__cutcell === view) { delete window.__cutcell }
    view = null
  }
  const draw = (vtk) => () => {
    const made = new SceneView(model, vtk, overlay)
    made.join(new Surroundings(made))
    // The graphics card was reset, as on a phone that was put away: all that it had is gone.
    const on = (type, act) => made.renderer.context.canvas.addEventListener(type, act)
    on("webglcontextlost", (e) => {
      if (made !== view) { return }
      e.preventDefault()  // else it is never restored
      camera = {position: made.insets.position, focal_point: made.orbit.target}
      end()
      overlay.say("The graphics card was reset. The view returns when it is ready\u00a0…")
    })
    on("webglcontextrestored", () => { if (!gone) { begin(draw(vtk)) } })
    return window.__cutcell = Object.assign(made, probe(made))
  }
  model.on("msg:custom", (message) => {
    if (message.page) { rememberPage(message.page) }
    if (!message.camera || !camera) { view?.receive(message); return }
    view?.receive({...message, camera: {...message.camera, now: camera}})
    camera = null
  })
  overlay = new Overlay()
  root.append(overlay.root)
  loadVtk(model.vtk_url).then((vtk) => {
    const trial = document.createElement("canvas").getContext("webgl2")
    if (!trial) { throw new Error("this browser offers no WebGL 2") }
    trial.getExtension("WEBGL_lose_context")?.loseContext()
    begin(draw(vtk))
  }).catch((error) => {
    console.info(`The server draws the 3D view: ${error.message}.`)
    begin(() => new PictureView(model, overlay))
  })
  const removeLink = skipLink("canvas", "Skip to the canvas", () => overlay.canvas)
  model.on("remove", () => { gone = true; end(); removeLink() })
  return root
}
