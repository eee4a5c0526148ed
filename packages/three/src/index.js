export { PeelnetPassNode, isOrderIndependent, isWanted, peelnetPass } from './pass.js';
export { FORMAT_VERSION, loadModel, modelProblem } from './model.js';
