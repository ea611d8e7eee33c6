// The lesson in one file, without a server: plays the views that were recorded for each step
// (headless/lesson_page.py).

import {element} from "../common/elements.js"
import {flatScene} from "../flat/scene.js"
import {lessonCard} from "../lesson/card.js"
import {Painted} from "./lesson_paint.js"
import {Stage} from "../lesson/stage.js"
import {Overlay} from "../view/overlay.js"
import {probe} from "../view/probe.js"
import {Player, standIn, unpack} from "./recorded.js"
import {SceneView} from "../view/scene_view.js"

// Parts of a view that are empty where nothing was recorded of them.
const EMPTY = {
  animation: null, blending: "linear", brush: null, clip: null, cut: null, front: null, gizmo: null,
  handles: null, legend: null, playing: false, pose: null, views: [],
}
const STEP = /^#step-(\d+)$/

class LessonPage {
  constructor(scenes, read, vtk) {
    this.scenes = scenes
    this.steps = scenes.steps
    this.read = read
    this.step = 0
    this.answers = {}
    this.scores = {}  // of what was painted, by step and method
    this.name = "ask"  // of the view that is shown
    this.dark = matchMedia("(prefers-color-scheme: dark)")
    this.calm = matchMedia("(prefers-reduced-motion: reduce)")
    this.staged = false
    const host = {
      go: (step) => this.go(step),
      answer: (value) => this.answer(value),
      offer: (index) => this.look(`offer ${index}`),
      set: (name, value) => this.set(name, value),
      stage: (on) => { this.staged = on; this.present() },
    }
    this.card = lessonCard(this.steps, host, ["picture", "flat"])
    this.stage = new Stage(this.card, host)
    this.stage.openNotes = () => {}  // the notes are a page of the server
    const overlay = new Overlay()
    this.flat = flatScene({
      answer: (value) => this.answer(value),
      close: () => { this.isInBody = true; this.present() },
      cards: () => [],  // they are beside the canvas
      project: () => this.view.renderer.projection(),
    })
    const over = element("div")
    over.attachShadow({mode: "open"}).append(this.flat.root)
    overlay.root.append(over)
    const place = element("div", {className: "lesson"})
    const unused = element("style", {}, "header > :last-child { display: none }")  // Leave
    place.attachShadow({mode: "open"}).append(this.card.root, unused)
    this.main = element("main", {}, overlay.root, place)
    document.body.append(this.main)
    this.view = new SceneView(standIn({
      "pick": ({joint}) => this.clicked("joint", joint),
      "pick-vertex": ({vertex}) => this.clicked("vertex", this.part("follows")?.[vertex]),
      "play": ({on}) => this.player.send({playing: on}),
      "paint": (stroke) => this.paint(stroke),
    }), vtk, overlay)
    this.player = new Player(this.view, read)
    window.__cutcell = Object.assign(this.view, probe(this.view))
  }

  begin() {
    this.dark.addEventListener("change", () => this.present())
    this.player.send({lights: this.scenes.lights})
    window.addEventListener("hashchange", () => this.go(this.addressed))
    this.go(this.addressed)
  }

  // The step that the address names.
  get addressed() {
    return Number(location.hash.match(STEP)?.[1] ?? 1) - 1
  }

  get record() {
    return this.scenes.records[this.step]
  }

  part(name) {
    return this.read(this.record[name])
  }

  go(step) {
    // Below the first step the lesson is over, and begins again.
    if (step < 0) { [this.answers, this.scores] = [{}, {}] }
    this.step = Math.min(Math.max(step, 0), this.steps.length - 1)
    this.strokes = null
    this.tau = null  // the winding threshold that a person has dragged, while the scene is flat
    this.view.time = 0
    this.look(this.step in this.answers ? "show" : "ask")
    const address = `#step-${this.step + 1}`
    if (location.hash !== address) { location.hash = address }
  }

  answer(value) {
    if (this.step in this.answers) { return }
    this.answers[this.step] = value && this.strokes ? this.painted() : value
    this.look("show")
  }

  // The score of what was painted, and that by each method which is compared.
  painted() {
    const {strokes, record} = this
    const scores = Object.entries(record.methods).map(([title, moved]) =>
      [title, strokes.score(this.read(moved))])
    this.scores[this.step] = Object.fromEntries(scores)
    return strokes.score(this.part("right"))
  }

  // A joint or a vertex of the picture was clicked.
  clicked(kind, joint) {
    const name = this.record.names[joint]
    if (name !== undefined && this.steps[this.step].answer.kind === kind) { this.answer(name) }
  }

  // Shows what was recorded for the nearest values.
  set(name, value) {
    const {views} = this.record
    const names = Object.keys(views).filter((one) => `&${one}`.includes(`&${name}=`))
    const away = (view) => Math.max(...view.split("&").map((part) => {
      const [one, text] = part.split("=")
      const wanted = one === name ? value : this.values[one].value
      return text === String(wanted) ? 0 : Math.abs(Number(text) - Number(wanted)) || Infinity
    }))
    const nearest = names.sort((a, b) => away(a) - away(b))[0]
    if (nearest) { this.look(nearest) } else { this.tau = value; this.present() }
  }

  look(name) {
    this.name = name
    this.isInBody = false
    this.present()
  }

  present() {
    const {messages, pressed, plot} = this.record.views[this.name]
    const {actors, camera, ...rest} = messages[Number(this.dark.matches)]
    const message = {...EMPTY, ...rest, theme: this.scenes.themes[Number(this.dark.matches)]}
    if (this.calm.matches) { Object.assign(message, {playing: false, animation: null}) }
    // The person's own view stays where the step does not change it.
    const place = JSON.stringify([this.step, camera])
    if (place !== this.place) { message.camera = camera }
    this.place = place
    this.player.show(actors, this.read(message))
    this.main.classList.toggle("staged", this.staged)
    this.showFlat()
    const {step, answers, scores, values, staged} = this
    const now = {step, answers, pressed, plot, scores: scores[step], values, staged}
    this.card.show(now)
    this.stage.show(now)
  }

  // The numbers in the text; the browser itself draws every winding threshold of a flat scene.
  get values() {
    const {values, flat} = this.record.views[this.name]
    if (!flat || this.tau === null) { return values }
    const {winding_threshold: threshold} = values
    return {...values, winding_threshold: {...threshold, value: this.tau}}
  }

  showFlat() {
    const {flat} = this.record.views[this.name]
    const isAct = this.steps[this.step].answer.kind === "act"
    const task = isAct ? (this.step in this.answers ? "done" : "open") : ""
    const colors = this.scenes.colors[Number(this.dark.matches)]
    if (!flat || this.isInBody) { this.flat.show({mode: "", colors}); return }
    const {mode, section, tau} = flat
    const data = this.scenes.sections[section]
    this.flat.show({data, mode, tau: this.tau ?? tau, colors, task})
  }

  paint(stroke) {
    const body = /** @type {Actor} */ (this.view.renderer.actors.get("body"))
    this.strokes ??= new Painted(body)
    this.strokes.pass(stroke, this.record.views[this.name].messages[0].brush.radius)
    const {actors} = this.record.views[this.name].messages[Number(this.dark.matches)]
    const paint = {...actors.body.paint, coloured: true}
    const painted = {...actors, body: {...actors.body, colors: this.strokes.colors, paint}}
    // The brush is done with what it tells before the answer comes, as from a server.
    queueMicrotask(() => this.player.show(painted, {painted: {}}))
  }
}

export const open = () => unpack((scenes, read, vtk) => new LessonPage(scenes, read, vtk).begin())
