export { PeelnetPassNode, isOrderIndependent, peelnetPass } from './pass.js';
export { FORMAT_VERSION, modelProblem } from './model.js';
