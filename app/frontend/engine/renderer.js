// The vtk.js window: two layers (the scene, and what is drawn over it), lights, frames.

import {withQuaternions} from "./dual_quaternions.js"
import {boxOf, isCharacter} from "../common/shape.js"
import {ImageLayers} from "./materials.js"
import {VIEW_ANGLE} from "../camera/orbit.js"
import {PoseTexture} from "./skin.js"
import {Smooth} from "./smooth.js"
import {Corners} from "./strokes.js"
import {noCards, shapeOf, tiles} from "../camera/tiles.js"
import {across, along, dot, minus, unit} from "../common/vectors.js"
import {drawAll, makeWindow, projectionMatrix} from "./vtk_private.js"

export function loadVtk(url) {
  window.__cutcellVtk ??= new Promise((resolve, reject) => {
    if (window.vtk) { resolve(window.vtk); return }
    const script = document.createElement("script")
    script.src = new URL(url, document.baseURI).href
    script.addEventListener("load", () => resolve(window.vtk))
    script.addEventListener("error", () => reject(new Error("the 3D library could not be loaded")))
    document.head.append(script)
  })
  return window.__cutcellVtk
}

// One view of several has its caption on top, in two lines if it is narrow.
const CAPTIONED = {left: 0, right: 0, top: 46, bottom: 16}
const NARROW_CAPTIONED = {...CAPTIONED, top: 60}
const NARROW_CAPTION = 260

export class Renderer {
  /** @param {any} vtk @param {HTMLElement} element */
  constructor(vtk, element) {
    this.vtk = vtk
    this.element = element
    const {vtkRenderWindow, vtkCamera} = vtk.Rendering.Core
    this.window = vtkRenderWindow.newInstance()
    this.window.setNumberOfLayers(2)
    this.camera = vtkCamera.newInstance()
    this.camera.setViewAngle(VIEW_ANGLE)
    this.lights = []
    this.size = [0, 0]  // of the canvas, in pixels of the screen
    this.views = []
    /** @type {Map<string, Actor>} */
    this.actors = new Map()
    const {gl, context} = makeWindow(vtk)
    this.gl = gl
    this.context = context
    this.smooth = new Smooth(context)
    this.poses = new PoseTexture(context)
    this.images = new ImageLayers(context)
    this.corners = new Corners(context)
    this.gl.setContainer(element)
    this.window.addView(this.gl)
    this.pose = null
    this.poseCount = 0
    this.insets = noCards(false)
    this.haze = [0.9, 0.9, 0.9]
    this.divide([])
    this.frames = 0
  }

  // Side by side, under one camera: as many views as there are captions, or a single one.
  divide(captions) {
    const count = Math.max(captions.length, 1)
    const {vtkRenderer} = this.vtk.Rendering.Core
    while (this.views.length < count) {
      const base = vtkRenderer.newInstance()
      const over = vtkRenderer.newInstance({layer: 1, preserveColorBuffer: true})
      base.setBackground(0, 0, 0, 0)
      for (const renderer of [base, over]) {
        renderer.setActiveCamera(this.camera)
        renderer.setAutomaticLightCreation(false)
        this.window.addRenderer(renderer)
      }
      this.views.push({base, over})
    }
    for (const {base, over} of this.views.splice(count)) {
      for (const renderer of [base, over]) { this.window.removeRenderer(renderer) }
    }
    this.light(this.lights)
    for (const actor of this.actors.values()) { actor.place() }
  }

  // The rectangle of each view, in pixels of the canvas.
  get tiles() {
    return this.tilesIn(this.insets)
  }

  // One view has the whole canvas, with cards over it; several divide what cards leave free, as
  // pictures are divided (viewers/tiles.py).
  tilesIn({left, right, top, bottom}) {
    const {clientWidth: w, clientHeight: h} = this.element
    if (this.views.length < 2) { return [[0, 0, w, h]] }
    const shape = shapeOf(this.bounds(isCharacter))
    const free = [Math.max(w - left - right, w / 4, 1), Math.max(h - top - bottom, h / 4, 1)]
    const captions = CAPTIONED.top + CAPTIONED.bottom
    return tiles(this.views.length, ...free, shape, captions)
      .map(([x, y, ...size]) => [left + x, top + y, ...size])
  }

  light(lights) {
    this.lights = lights
    const {vtkLight} = this.vtk.Rendering.Core
    for (const renderer of this.views.flatMap(({base, over}) => [base, over])) {
      renderer.removeAllLights()
      for (const [position, intensity] of lights) {
        const light = vtkLight.newInstance({position, focalPoint: [0, 0, 0], intensity})
        light.setLightTypeToCameraLight()
        renderer.addLight(light)
      }
    }
  }

  setPose(pose, dual = false) {
    this.pose = pose && dual ? withQuaternions(pose) : pose
    this.dual = dual
    this.poseCount += 1  // the array may be the one of before, with other numbers
    this.poses.set(this.pose, dual)
  }

  resize(coarse = false) {
    const {clientWidth: w, clientHeight: h} = this.element
    const ratio = Math.min(window.devicePixelRatio || 1, 2) * (coarse ? 0.6 : 1)
    const size = [Math.max(1, Math.round(w * ratio)), Math.max(1, Math.round(h * ratio))]
    if (this.size.join() === size.join()) { return }
    this.size = size
    this.gl.setSize(...size)
  }

  look(orbit) {
    const windowCenter = this.middle.map((x) => -x)
    this.camera.set({
      position: orbit.position, focalPoint: orbit.target, viewUp: [0, 1, 0], windowCenter,
    })
  }

  // A machine that is slow at it gets rough edges while things change, fewer lines and larger
  // pixels while they move, and the full picture when they rest.
  draw(moving, resting) {
    const {smooth} = this
    this.rough = !resting && smooth.slow
    this.resize(moving && smooth.slower)
    const {clientWidth: w, clientHeight: h} = this.element
    this.tiles.forEach(([left, top, width, height], i) => {
      const part = [left / w, 1 - (top + height) / h, (left + width) / w, 1 - top / h]
      const {base, over} = this.views[i]
      for (const renderer of [base, over]) { renderer.setViewport(...part) }
    })
    const outside = this.isOutside()
    this.moving = moving
    for (const actor of this.actors.values()) { actor.show(outside) }
    this.camera.setClippingRange(...this.depthRange())
    smooth.draw(this.size, this.rough, () => { this.clear(); drawAll(this.gl) })
    this.frames += 1
  }

  // Views clear what is theirs; around them there may be what was seen before.
  clear() {
    const gl = this.context
    gl.disable(gl.SCISSOR_TEST)
    gl.clearColor(0, 0, 0, 0)
    gl.clear(gl.COLOR_BUFFER_BIT)
  }

  // Takes halfway between the colours of the background, as a style sheet writes them, for haze.
  fadeInto({top, bottom}) {
    const part = (color, i) => parseInt(color.slice(i, i + 2), 16)
    this.haze = [1, 3, 5].map((i) => (part(top, i) + part(bottom, i)) / 510)
  }

  // Whether the camera is well outside all actors, in any pose.
  isOutside() {
    const {size, middle} = boxOf(this.bounds())
    const away = minus(this.camera.getPosition(), middle)
    return away.some((x, i) => Math.abs(x) > (size[i] + Math.max(...size)) / 2)
  }

  depthRange() {
    const {size, middle} = boxOf(this.bounds())
    const radius = Math.hypot(...size)
    const away = Math.hypot(...minus(this.camera.getPosition(), middle))
    return [Math.max(away - radius, this.camera.getDistance() * 0.02), away + radius * 1.5]
  }

  // Between what distances the character lies: what is farther in it is hazier.
  get nearAndFar() {
    const eye = this.camera.getPosition()
    const {size, middle} = boxOf(this.bounds(isCharacter))
    const ahead = unit(minus(this.camera.getFocalPoint(), eye))
    const along = dot(minus(middle, eye), ahead)
    const half = dot(ahead.map(Math.abs), size) / 2
    return [along - half, along + half]
  }

  /** @param {(actor: Actor) => boolean} [those] */
  bounds(those = () => true) {
    const b = [Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity]
    for (const actor of this.actors.values()) {
      if (!actor.bounds || !actor.rest?.length || !those(actor)) { continue }
      for (let i = 0; i < 6; i += 2) {
        b[i] = Math.min(b[i], actor.bounds[i])
        b[i + 1] = Math.max(b[i + 1], actor.bounds[i + 1])
      }
    }
    return Number.isFinite(b[0]) ? b : [-1, 1, -1, 1, -1, 1]
  }

  // What is not for the character, of a view of some width.
  taken(insets, width) {
    if (this.views.length < 2) { return insets }
    return width < NARROW_CAPTION ? NARROW_CAPTIONED : CAPTIONED
  }

  // Where the middle of what is free in a view lies, in halves of the view from its own middle.
  get middle() {
    const [, , w, h] = this.tiles[0]
    const {left, right, top, bottom} = this.taken(this.insets, w)
    return [(left - right) / Math.max(w, 1), (bottom - top) / Math.max(h, 1)]
  }

  // Where on the canvas what one looks at is seen.
  get target() {
    const [left, top, w, h] = this.tiles[0]
    const [aside, above] = this.middle
    return [left + (1 + aside) / 2 * w, top + (1 - above) / 2 * h]
  }

  /**
   * How far a place of the canvas is from where its view's target is seen, in pixels of the whole
   * canvas. @param {number[]} at
   */
  fromTarget([x, y]) {
    const [left, top, w, h] = this.tiles[this.viewAt(x, y)]
    const [aside, above] = this.middle
    return [x - left - (1 + aside) / 2 * w, y - top - (1 - above) / 2 * h]
      .map((d) => d * this.element.clientHeight / h)
  }

  // Which view a pixel of the canvas belongs to.
  viewAt(x, y) {
    /** @param {number[]} tile */
    const hit = ([left, top, width, height]) =>
      x >= left && x < left + width && y >= top && y < top + height
    return Math.max(this.tiles.findIndex(hit), 0)
  }

  // A function from points of the scene to pixels of the canvas and depth, as seen in one of the
  // views; null behind the eye. It holds while the camera stays.
  projection(view = 0) {
    const [left, top, w, h] = this.tiles[view]
    const m = projectionMatrix(this.camera, w / h)
    return ([x, y, z]) => {
      const row = (r) => m[4 * r] * x + m[4 * r + 1] * y + m[4 * r + 2] * z + m[4 * r + 3]
      const depth = row(3)
      return depth <= 0 ? null
        : [left + (row(0) / depth + 1) / 2 * w, top + (1 - row(1) / depth) / 2 * h, depth]
    }
  }

  project(point, view = 0) {
    return this.projection(view)(point)
  }

  // How long a pixel is at a depth, in the scene.
  pixel(depth) {
    return 2 * depth * Math.tan(VIEW_ANGLE * Math.PI / 360) / this.tiles[0][3]
  }

  // From pixels of the canvas to a ray of the scene.
  ray(x, y) {
    const [left, top, w, h] = this.tiles[this.viewAt(x, y)]
    const origin = this.camera.getPosition()
    const ahead = unit(minus(this.camera.getFocalPoint(), origin))
    const {right, up} = across(ahead)
    const slope = Math.tan(VIEW_ANGLE * Math.PI / 360)
    const [aside, above] = this.middle
    const [a, b] = [
      (2 * (x - left) / w - 1 - aside) * slope * w / h, (1 - 2 * (y - top) / h - above) * slope,
    ]
    return {origin, direction: unit(along(ahead, [a, right], [b, up]))}
  }

  remove() {
    const {poses, images, corners, smooth} = this
    for (const part of [...this.actors.values(), poses, images, corners, smooth]) { part.remove() }
    this.gl.setContainer(null)
    this.gl.delete()
    this.window.delete()
  }
}
