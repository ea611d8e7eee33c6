// One actor of the scene, drawn by vtk.js; changed in place by what the server sends.

const MANY_LINES = 40000

// Arrays arrive as Bokeh's own subclasses, whose names vtk.js does not know.
function plain(array) {
  const base = Object.getPrototypeOf(array.constructor)
  const Type = base.name && base.name !== "TypedArray" && base !== Function.prototype
    ? base : array.constructor
  return new Type(array.buffer, array.byteOffset, array.length)
}

function withCounts(cells, corners, stride = 1) {
  const total = Math.ceil(cells.length / corners / stride)
  const out = new Uint32Array(total * (corners + 1))
  for (let i = 0; i < total; i++) {
    out[i * (corners + 1)] = corners
    for (let c = 0; c < corners; c++) {
      out[i * (corners + 1) + 1 + c] = cells[i * stride * corners + c]
    }
  }
  return out
}

class Figure {
  constructor(vtk, renderers) {
    this.vtk = vtk
    this.renderers = renderers
    this.data = vtk.Common.DataModel.vtkPolyData.newInstance()
    this.made = [this.make(this.data)]
    this.visible = true
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
    if (part.kind) { this.kind = part.kind }
    if (part.points) { this.setPoints(plain(part.points)) }
    if (part.normals) { this.setNormals(plain(part.normals)) }
    if (part.cells) { this.setCells(plain(part.cells)) }
    if (part.skin) {
      const {joints, weights, count} = part.skin
      this.skin = {joints: plain(joints), weights: plain(weights), count}
    }
    if (part.colors) { this.setColors(plain(part.colors)) }
    if (part.scalars) { this.setScalars(plain(part.scalars), plain(part.table), part.limits) }
    if (part.paint) { this.paint(part.paint) }
    if ("overlay" in part) { this.place(part.overlay) }
    if ("clipped" in part) { [this.clipped, this.slab] = [part.clipped, part.slab] }
    if ("visible" in part) { this.visible = part.visible }
    this.cut(cut)
  }

  setPoints(points) {
    this.rest = points
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
    const corners = {surface: 3, lines: 2, points: 1}[this.kind]
    const put = (data, stride) => {
      const array = {surface: "Polys", lines: "Lines", points: "Verts"}[this.kind]
      data[`get${array}`]().setData(withCounts(cells, corners, stride))
      data.modified()
    }
    put(this.data, 1)
    this.count = cells.length / corners
    // While the camera moves, a twin with fewer lines stands in.
    if (this.kind === "lines" && this.count > MANY_LINES && this.made.length < 2) {
      const few = this.vtk.Common.DataModel.vtkPolyData.newInstance()
      few.setPoints(this.data.getPoints())
      this.made.push(this.make(few))
      put(few, Math.ceil(this.count / MANY_LINES))
    }
  }

  setColors(colors) {
    this.setArray(colors, 3)
    for (const {mapper} of this.made) {
      mapper.setColorModeToDirectScalars()
      mapper.setInterpolateScalarsBeforeMapping(false)
    }
  }

  setScalars(values, table, limits) {
    this.setArray(values, 1)
    const {vtkLookupTable, vtkDataArray} = this.vtk.Common.Core
    const size = table.length / 3
    const rgba = new Uint8Array(size * 4).fill(255)
    for (let i = 0; i < size; i++) { rgba.set(table.subarray(3 * i, 3 * i + 3), 4 * i) }
    const lookup = vtkLookupTable.newInstance()
    lookup.setTable(vtkDataArray.newInstance({numberOfComponents: 4, values: rgba}))
    lookup.setRange(limits[0], limits[1])
    for (const {mapper} of this.made) {
      mapper.setColorModeToMapScalars()
      mapper.setInterpolateScalarsBeforeMapping(true)
      mapper.setUseLookupTableScalarRange(true)
      mapper.setLookupTable(lookup)
    }
  }

  setArray(values, numberOfComponents) {
    const {vtkDataArray} = this.vtk.Common.Core
    this.data.getPointData().setScalars(vtkDataArray.newInstance({
      name: "values", numberOfComponents, values,
    }))
    this.data.modified()
  }

  paint({color, opacity, width, ambient, coloured}) {
    for (const {mapper, actor} of this.made) {
      const look = actor.getProperty()
      look.setColor(...color)
      look.setOpacity(opacity)
      look.setPointSize(width)
      look.setAmbient(ambient)
      look.setLighting(this.kind === "surface")
      if (!this.restNormals) { look.setInterpolationToFlat() }
      mapper.setScalarVisibility(coloured)
      if (this.kind === "lines") {
        mapper.setRelativeCoincidentTopologyLineOffsetParameters(0, -4)
      }
    }
  }

  place(overlay) {
    this.layer = this.renderers[overlay ? 1 : 0]
    for (const {actor} of this.made) {
      for (const renderer of this.renderers) { renderer.removeActor(actor) }
      this.layer.addActor(actor)
    }
  }

  cut(cut) {
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

  show(moving) {
    const few = moving && this.made.length > 1
    this.made.forEach(({actor}, i) => {
      actor.setVisibility(this.visible && (this.made.length === 1 || few === (i === 1)))
    })
  }

  pose(pose) {
    if (!this.skin || !this.rest) { return }
    const points = this.data.getPoints()
    const normals = this.restNormals && this.data.getPointData().getNormals()
    if (pose) {
      skinInto(this.skin, this.rest, this.restNormals, pose, points.getData(), normals?.getData())
    } else {
      points.getData().set(this.rest)
      normals?.getData().set(this.restNormals)
    }
    points.modified()
    normals?.modified()
    this.data.modified()
  }

  remove() {
    for (const {actor, mapper, data} of this.made) {
      this.layer?.removeActor(actor)
      actor.delete()
      mapper.delete()
      data.delete()
    }
  }
}

function plainList(values) {
  return Array.from(values)
}
