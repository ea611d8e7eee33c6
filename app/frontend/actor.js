// One actor of the scene, drawn by vtk.js; changed in place by what the server sends.

import {plain, plainList} from "./arrays.js"
import {ALL, Colours, pointIds} from "./colour.js"
import {Materials} from "./materials.js"
import {shaderSwaps} from "./shade.js"
import {skinArrays, skinned, withRows} from "./skin.js"
import {Strokes} from "./strokes.js"
import {TriangleTree} from "./triangle_tree.js"

const MANY_LINES = 40000

// Corners of triangles as vtk.js keeps them: their number comes before each.
function withCounts(cells) {
  const out = new Uint32Array(cells.length / 3 * 4)
  for (let i = 0, at = 0; i < cells.length; i += 3) {
    out[at++] = 3
    for (let c = 0; c < 3; c++) { out[at++] = cells[i + c] }
  }
  return out
}

function boundsOf(points) {
  const b = [Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity]
  for (let i = 0; i < points.length; i++) {
    const k = 2 * (i % 3)
    if (points[i] < b[k]) { b[k] = points[i] }
    if (points[i] > b[k + 1]) { b[k + 1] = points[i] }
  }
  return b
}

export class Actor {
  constructor(renderer) {
    const {vtk} = renderer
    this.vtk = vtk
    this.renderer = renderer
    this.data = vtk.Common.DataModel.vtkPolyData.newInstance()
    this.made = [this.make(this.data)]
    this.colours = new Colours(renderer.context)
    this.visible = true
    this.skinCount = 0
  }

  make(data) {
    const {vtkMapper, vtkActor} = this.vtk.Rendering.Core
    const mapper = vtkMapper.newInstance({scalarVisibility: false})
    mapper.setInputData(data)
    const actor = vtkActor.newInstance()
    actor.setMapper(mapper)
    return {data, mapper, actor}
  }

  update(part, cut) {
    if (part.kind) { this.begin(part.kind) }
    if (part.points) { this.setPoints(plain(part.points)) }
    if (part.normals) { this.setNormals(plain(part.normals)) }
    if (part.cells) { this.setCells(plain(part.cells)) }
    if ("skin" in part || "apart" in part) { this.setSkins(part) }
    if (part.colors) {
      this.colors = plain(part.colors)
      this.colours.setColors(this.colors)
    }
    if (part.scalars) {
      this.values = plain(part.scalars)
      this.looked = [plain(part.table), part.limits]
      this.colours.setValues(this.values, ...this.looked)
    }
    if (part.materials) {
      this.materials ??= new Materials(this.renderer.context)
      this.materials.set(part.materials)
      this.colours.by = "materials"
    }
    if (part.paint) { this.paint(part.paint) }
    this.shade()
    if (part.place) {
      [this.overlay, this.view] = [part.place.overlay, part.place.view]
      this.place()
    }
    if ("reading" in part) {
      const {reading} = part
      this.reading = reading && {...reading, values: reading.values && plain(reading.values)}
    }
    if ("animation" in part) { this.animation = part.animation }
    if ("clipped" in part) { [this.clipped, this.slab] = [part.clipped, part.slab] }
    if ("visible" in part) { this.visible = part.visible }
    this.cut(cut)
  }

  // Gives some vertices other weights than the server's last.
  repaint(painted) {
    this.recolour(painted)
    this.reskin(painted)
  }

  recolour({vertices, colors, scalars}) {
    const {by} = this.colours
    if (by === "colors" && colors) {
      this.colors = replaced(this.colors, 3, vertices, colors)
      this.colours.setColors(this.colors)
    } else if (by === "values" && scalars) {
      this.values = replaced(this.values, 1, vertices, scalars)
      this.colours.setValues(this.values, ...this.looked)
    }
  }

  reskin({vertices, joints, weights, count}) {
    if (!this.skin || !joints) { return }
    this.skin = withRows(this.skin, vertices, {joints: plain(joints), weights: plain(weights), count})
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
    const [{data, mapper}] = this.made
    data.getPoints().setData(new Float32Array(6), 3)
    data.getLines().setData(Uint32Array.of(2, 0, 1))
    mapper.getViewSpecificProperties().ShadersCallbacks = [{callback: () => this.stroke()}]
  }

  stroke() {
    const {renderer, look, strokes} = this
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
    const {vtkDataArray} = this.vtk.Common.Core
    this.data.getPointData().setNormals(vtkDataArray.newInstance({
      name: "Normals", numberOfComponents: 3, values: normals.slice(),
    }))
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
    const needs = {sets: sets(skin), otherSets: sets(skin && apart), by: this.coloured ? this.colours.by : ""}
    const shaded = JSON.stringify([needs, this.rest.length, this.skinCount])
    if (shaded === this.shaded || !(needs.sets || needs.by || this.shaded)) { return }
    this.shaded = shaded
    const arrays = [
      ...needs.by ? [["pointId", pointIds(this.rest.length / 3), 1]] : [],
      ...needs.sets ? skinArrays("skin", skin) : [],
      ...needs.otherSets ? skinArrays("other", apart) : [],
    ]
    for (const {data, mapper} of this.made) {
      this.attach(data, arrays)
      mapper.setCustomShaderAttributes(arrays.map(([name]) => name))
      Object.assign(mapper.getViewSpecificProperties(), {
        OpenGL: {ShaderReplacements: shaderSwaps(needs)},
        ShadersCallbacks: [{callback: (_, primitive) => this.use(primitive)}],
      })
      mapper.modified()
    }
  }

  attach(data, arrays) {
    const {vtkDataArray} = this.vtk.Common.Core
    const held = data.getPointData()
    for (const [name, values, numberOfComponents = 4] of arrays) {
      held.removeArray(name)
      held.addArray(vtkDataArray.newInstance({name, numberOfComponents, values}))
    }
    data.modified()
  }

  // Called by vtk.js before it draws.
  use(primitive) {
    const program = primitive.getProgram()
    this.renderer.poses.use(program, primitive.getCABO(), this.apart?.unit)
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

  paint({color, opacity, width, thick, dash, form, ambient, diffuse, coloured, behind, closed, hull, edges}) {
    this.closed = closed
    this.hull = hull
    this.coloured = coloured
    if (this.strokes) {
      this.strokes.form = form
      this.look = {color, opacity, width, thick, dash, coloured}
      return
    }
    const [{mapper, actor}] = this.made
    const look = actor.getProperty()
    look.setColor(...color)
    look.setOpacity(opacity)
    look.setAmbient(ambient)
    look.setDiffuse(diffuse)
    look.setLighting(!hull)
    look.setEdgeVisibility(edges)
    look.setEdgeColor(0.1, 0.12, 0.16)
    look.setFrontfaceCulling(hull)
    if (!this.restNormals) { look.setInterpolationToFlat() }
    if (behind) { mapper.setRelativeCoincidentTopologyPolygonOffsetParameters(2, 30) }
  }

  // Belongs to one view, or to all of them.
  place() {
    this.leave()
    const own = typeof this.view === "number" ? this.renderer.views[this.view] : null
    const views = own ? [own] : this.renderer.views
    this.layers = views.map((view) => this.overlay ? view.over : view.base)
    for (const {actor} of this.made) {
      for (const layer of this.layers) { layer.addActor(actor) }
    }
  }

  // Whether it is seen in a view.
  standsIn(view) {
    return typeof this.view !== "number" || this.view === view
  }

  leave() {
    for (const {actor} of this.made) {
      for (const layer of this.layers || []) { layer.removeActor(actor) }
    }
  }

  cut(cut) {
    this.opened = Boolean(cut && this.clipped)
    if (this.strokes) {
      this.plane = this.opened && {origin: plainList(cut.origin), normal: plainList(cut.normal)}
      return
    }
    for (const {mapper} of this.made) {
      mapper.removeAllClippingPlanes()
      if (!cut || !this.clipped) { continue }
      const {vtkPlane} = this.vtk.Common.DataModel
      const [origin, normal] = [plainList(cut.origin), plainList(cut.normal)]
      mapper.addClippingPlane(vtkPlane.newInstance({origin, normal: normal.map((x) => -x)}))
      if (this.slab > 0) {
        const back = origin.map((x, i) => x - this.slab * normal[i])
        mapper.addClippingPlane(vtkPlane.newInstance({origin: back, normal}))
      }
    }
  }

  // `outside`: the eye is, so that of a closed surface no back is seen unless it is cut.
  show(outside) {
    const whole = this.closed && outside && !this.opened
    const [{actor}] = this.made
    actor.getProperty().setBackfaceCulling(Boolean(whole))
    actor.setVisibility(this.visible)
  }

  // Where the points are now; the card alone knows as long as nobody asks.
  posed() {
    const {pose, poseCount} = this.renderer
    if (!this.skin || !pose) { return this.rest }
    const known = this.known
    if (known?.poseCount !== poseCount || known.skin !== this.skin || known.rest !== this.rest) {
      const {skin, rest} = this
      this.known = {poseCount, skin, rest, points: skinned(skin, rest, pose)}
    }
    return this.known.points
  }

  // For rays: grown when first asked for, and fitted to where the points are now.
  get tree() {
    if (this.grown?.triangles !== this.triangles) {
      this.grown = new TriangleTree(this.rest, this.triangles)
    }
    this.grown.fit(this.posed())
    return this.grown
  }

  remove() {
    this.leave()
    this.strokes?.remove()
    this.materials?.remove()
    this.colours.remove()
    for (const {actor, mapper} of this.made) {
      actor.delete()
      mapper.delete()
    }
    for (const {data} of this.made) { data.delete() }
  }
}

// A copy of numbers, some at a place, with others at some places.
export function replaced(numbers, size, places, others) {
  const made = numbers.slice()
  places.forEach((place, i) => {
    for (let k = 0; k < size; k++) { made[size * place + k] = others[size * i + k] }
  })
  return made
}

// What is to be seen whole; bones may reach far out of it, those above all that move nothing.
export function isCharacter(actor) {
  return !actor.overlay
}
