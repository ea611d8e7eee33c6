// One actor of the scene, drawn by vtk.js; changed in place by what the server sends.

import {plain} from "../common/panel.js"
import {ALL, Colours, pointIds} from "./colour.js"
import {Materials} from "./materials.js"
import {shaderSwaps} from "./shade.js"
import {skinArrays, skinned, withRows} from "./skin.js"
import {Strokes} from "./strokes.js"
import {boundsOf, replace, withCounts} from "../common/shape.js"
import {TriangleTree} from "./triangle_tree.js"
import {along} from "../common/vectors.js"
import {beforeDrawing, changeShaders, pushBack} from "./vtk_private.js"

const MANY_LINES = 40000

export class Actor {
  /** @param {Renderer} renderer */
  constructor(renderer) {
    const {vtk} = renderer
    this.vtk = vtk
    this.renderer = renderer
    this.data = vtk.Common.DataModel.vtkPolyData.newInstance()
    this.mapper = vtk.Rendering.Core.vtkMapper.newInstance({scalarVisibility: false})
    this.mapper.setInputData(this.data)
    this.actor = vtk.Rendering.Core.vtkActor.newInstance()
    this.actor.setMapper(this.mapper)
    this.colours = new Colours(renderer.context)
    this.visible = true
    this.skinCount = 0
    this.slab = 0
    /** @type {any} */
    this.look = null
    this.count = 0
    /** @type {Strokes | null} */
    this.strokes = null
    /** @type {Float32Array} */
    this.rest = new Float32Array(0)
    /** @type {{joints: Uint16Array, weights: Float32Array, count: number} | null} */
    this.skin = null
    /** @type {{joints: Uint16Array, weights: Float32Array, count: number, unit: number} | null} */
    this.apart = null
  }

  /** @param {Part} part @param {Cut | null} cut */
  update(part, cut) {
    if (part.kind) { this.begin(part.kind) }
    if (part.points) { this.setPoints(plain(part.points)) }
    if (part.normals) { this.setNormals(plain(part.normals)) }
    if (part.cells) { this.setCells(plain(part.cells)) }
    if ("skin" in part || "apart" in part) { this.setSkins(part) }
    if (part.colors) { this.colours.setColors(plain(part.colors)) }
    if (part.scalars) {
      this.colours.setValues(plain(part.scalars), plain(part.table), part.limits)
    }
    if (part.repainted) { this.repaint(part.repainted) }
    if (part.materials) {
      this.materials = this.materials ?? new Materials(this.renderer.context)
      this.materials.set(part.materials)
      this.colours.by = "materials"
    }
    if (part.paint) { this.paint(part.paint) }
    this.shade()
    if (part.place) {
      this.overlay = part.place.overlay
      this.view = part.place.view
      this.place()
    }
    if ("reading" in part) {
      const {reading} = part
      this.reading = reading && {...reading, values: reading.values && plain(reading.values)}
    }
    if ("animation" in part) { this.animation = part.animation }
    if ("clipped" in part) {
      this.clipped = part.clipped
      this.slab = part.slab ?? 0
    }
    if (part.visible !== undefined) { this.visible = part.visible }
    this.cut(cut)
  }

  /** Gives some vertices other weights than the server's last. @param {Painted} painted */
  repaint(painted) {
    this.colours.repaint(painted)
    const {vertices, readings} = painted
    const values = this.reading?.values
    if (values && vertices && readings) { replace(values, 1, vertices, readings) }
    this.reskin(painted)
  }

  /** @param {Painted} painted */
  reskin({vertices, joints, weights, count}) {
    if (!this.skin || !joints) { return }
    const rows = {joints: plain(joints), weights: plain(weights), count}
    this.skin = withRows(this.skin, vertices, rows)
    this.skinChanged()
    this.shade()
  }

  // Lines and points are drawn by strokes.js, where vtk.js would draw a line without length.
  begin(kind) {
    this.kind = kind
    this.strokes?.remove()
    this.strokes = null
    if (kind === "surface") { return }
    this.strokes = new Strokes(this.renderer, kind)
    this.colours = this.strokes.colours
    this.data.getPoints().setData(new Float32Array(6), 3)
    this.data.getLines().setData(Uint32Array.of(2, 0, 1))
    beforeDrawing(this.mapper, () => this.stroke())
  }

  stroke() {
    const {renderer, look} = this
    const strokes = /** @type {Strokes} */ (this.strokes)
    if (this.skin && this.drawnPose !== renderer.poseCount) {
      strokes.setPoints(this.posed())
      this.drawnPose = renderer.poseCount
    }
    const every = renderer.moving ? Math.max(1, Math.ceil(this.count / MANY_LINES)) : 1
    const quick = renderer.rough
    strokes.draw({...look, cut: this.opened && this.plane, slab: this.slab, every, quick})
  }

  setPoints(points) {
    // A skin of another number of points is one of another mesh; the server does not take it back.
    if (points.length !== this.rest?.length) { this.setSkins({skin: null, apart: null}) }
    this.rest = points
    if (this.strokes) {
      this.strokes.setPoints(points)
      this.drawnPose = null
      this.bounds = boundsOf(points)
      return
    }
    this.data.getPoints().setData(points.slice(), 3)
    this.data.modified()
    this.bounds = this.data.getBounds()
  }

  setNormals(normals) {
    this.restNormals = normals
    this.data.getPointData().setNormals(this.array("Normals", normals.slice(), 3))
  }

  setCells(cells) {
    this.count = cells.length / {surface: 3, lines: 2, points: 1}[this.kind]
    if (this.strokes) {
      this.strokes.setCells(cells)
      if (this.kind === "lines") { this.pairs = cells }
      return
    }
    this.data.getPolys().setData(withCounts(cells))
    this.data.modified()
    this.triangles = cells
  }

  // How the points follow the joints, and a second skin, the distance to which colours them.
  /** @param {Part} skins */
  setSkins({skin, apart}) {
    const plainSkin = ({joints, weights, count}) =>
      ({joints: plain(joints), weights: plain(weights), count})
    if (skin !== undefined) { this.skin = skin && plainSkin(skin) }
    if (apart !== undefined) {
      this.apart = apart && {...plainSkin(apart), unit: apart.unit}
    }
    this.skinChanged()
  }

  skinChanged() {
    this.skinCount += 1
    this.drawnPose = null
  }

  // Changes the shaders to what moves and colours the points now; nothing while that is the same.
  shade() {
    if (this.strokes) { return }
    const {skin, apart} = this
    const sets = (of) => of ? Math.ceil(of.count / 4) : 0
    const by = this.coloured ? this.colours.by : ""
    const needs = {sets: sets(skin), otherSets: sets(skin && apart), by}
    const shaded = JSON.stringify([needs, this.rest.length, this.skinCount])
    if (shaded === this.shaded || !(needs.sets || needs.by || this.shaded)) { return }
    this.shaded = shaded
    const arrays = [
      ...needs.by ? [["pointId", pointIds(this.rest.length / 3), 1]] : [],
      ...skin ? skinArrays("skin", skin) : [],
      ...skin && apart ? skinArrays("other", apart) : [],
    ]
    const held = this.data.getPointData()
    for (const [name, values, numberOfComponents = 4] of arrays) {
      held.removeArray(name)
      held.addArray(this.array(name, values, numberOfComponents))
    }
    this.data.modified()
    changeShaders(this.mapper, shaderSwaps(needs), arrays.map(([name]) => name))
    beforeDrawing(this.mapper, (program, buffer) => this.use(program, buffer))
  }

  array(name, values, numberOfComponents) {
    return this.vtk.Common.Core.vtkDataArray.newInstance({name, values, numberOfComponents})
  }

  use(program, buffer) {
    this.renderer.poses.use(program, buffer, this.apart?.unit)
    if (this.coloured && this.colours.by === "materials") {
      this.materials.use(program, this.renderer.images)
    } else {
      this.colours.use(program)
    }
    this.renderer.context.activeTexture(this.renderer.context.TEXTURE0)
  }

  // Values beyond the front are left grey.
  setFront(front) {
    this.colours.front = this.animation ? front ?? ALL : ALL
  }

  /** @param {Paint} paint */
  paint(paint) {
    const {color, opacity, coloured, closed, hull} = paint
    this.closed = closed
    this.hull = hull
    this.coloured = coloured
    if (this.strokes) {
      this.strokes.form = paint.form
      this.look = paint
      return
    }
    const look = this.actor.getProperty()
    look.setColor(...color)
    look.setOpacity(opacity)
    look.setAmbient(paint.ambient)
    look.setDiffuse(paint.diffuse)
    look.setLighting(!hull)
    look.setEdgeVisibility(paint.edges)
    look.setEdgeColor(0.1, 0.12, 0.16)
    look.setFrontfaceCulling(hull)
    if (!this.restNormals) { look.setInterpolationToFlat() }
    if (paint.behind) { pushBack(this.mapper) }
  }

  // Belongs to one view, or to all of them.
  place() {
    this.leave()
    const own = typeof this.view === "number" ? this.renderer.views[this.view] : null
    const views = own ? [own] : this.renderer.views
    this.layers = views.map((view) => this.overlay ? view.over : view.base)
    for (const layer of this.layers) { layer.addActor(this.actor) }
  }

  // Whether it is seen in a view.
  standsIn(view) {
    return typeof this.view !== "number" || this.view === view
  }

  leave() {
    for (const layer of this.layers || []) { layer.removeActor(this.actor) }
  }

  cut(cut) {
    this.opened = Boolean(cut && this.clipped)
    if (this.strokes) {
      this.plane = this.opened && {origin: [...cut.origin], normal: [...cut.normal]}
      return
    }
    this.mapper.removeAllClippingPlanes()
    if (!this.opened) { return }
    const clip = (plane) =>
      this.mapper.addClippingPlane(this.vtk.Common.DataModel.vtkPlane.newInstance(plane))
    const [origin, normal] = [[...cut.origin], [...cut.normal]]
    clip({origin, normal: normal.map((x) => -x)})
    if (this.slab > 0) { clip({origin: along(origin, [-this.slab, normal]), normal}) }
  }

  // `outside`: the eye is, so that of a closed surface no back is seen unless it is cut.
  show(outside) {
    const whole = this.closed && outside && !this.opened
    this.actor.getProperty().setBackfaceCulling(Boolean(whole))
    this.actor.setVisibility(this.visible)
  }

  // The current positions of the points; until this is called, only the graphics card has them.
  posed() {
    const {pose, dual, poseCount} = this.renderer
    if (!this.skin || !pose) { return this.rest }
    const last = this.lastPosed
    if (last?.poseCount !== poseCount || last.skin !== this.skin || last.rest !== this.rest) {
      const {skin, rest} = this
      this.lastPosed = {poseCount, skin, rest, points: skinned(skin, rest, pose, dual)}
    }
    return this.lastPosed.points
  }

  get values() {
    return this.colours.values
  }

  // For rays: grown when first asked for, and fitted to where the points are now.
  get tree() {
    const tree = this.grown?.triangles === this.triangles ? this.grown
      : new TriangleTree(this.rest, this.triangles)
    this.grown = tree
    tree.fit(this.posed())
    return tree
  }

  remove() {
    this.leave()
    this.strokes?.remove()
    this.materials?.remove()
    this.colours.remove()
    for (const made of [this.actor, this.mapper, this.data]) { made.delete() }
  }
}
