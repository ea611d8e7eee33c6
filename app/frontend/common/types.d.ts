// Names of types for the comments of the scripts.

type Actor = import("../engine/actor.js").Actor
type Overlay = import("../view/overlay.js").Overlay
type Orbit = import("../camera/orbit.js").Orbit
type Renderer = import("../engine/renderer.js").Renderer
type SceneView = import("../view/scene_view.js").SceneView
type GL = WebGL2RenderingContext
type Frame = Camera & {centre: [number, number]; tiles: number[][]}
type Tell = (message: FromBrowser) => void

// A widget of the page, as Panel shows it to its script.
type Model = {
  send_msg(message: FromBrowser): void
  on(name: string, act: (message?: any) => void): void
  off?(name: string, act: (message?: any) => void): void
  [name: string]: any
}

// The answer that a step of a lesson asks for, and the step: app/features/learn/lesson.py.
type Answer = {
  kind: 'choice' | 'number' | 'vertex' | 'joint' | 'paint' | 'act'
  prompt?: string; options?: string[]; expected?: any; unit?: string; tolerance?: number
  button?: string
}
type Step = Record<'title' | 'question' | 'text' | 'sentence' | 'picture' | 'notes' | 'plot', string>
  & {answer: Answer; offers: string[]}
type LessonNow = {
  step: number; answers: Record<string, any>; pressed: boolean[]; values: Record<string, any>
  staged: boolean; plot?: any; scores?: Record<string, number>
}
type LessonHost = {
  go(step: number): void; answer(value: any): void; offer(index: number): void
  set(name: string, value: any): void; stage(on: boolean): void
}

interface Window {
  vtk: any
  __cutcell: any
  __cutcellVtk: Promise<any>
}
