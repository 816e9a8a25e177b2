% What is the same in the test file of every robot: everything after the line BEGIN is taken in as it stands.
% BEGIN
    forwardDynamicsSolvesTheEquationOfMotion(states);
    inertiaMatrixIsSymmetricAndPositiveDefinite();
    inertiaRatesMinusTwiceCoriolisAreSkew();
    torquesAreThoseOfTheMatricesAndOfTheRegressor();
    functionsAtRunTimeParametersAreThePlainOnesAtTheNominalParameters();
    gravityIsTheSlopeOfThePotentialEnergy();
    parametersHaveTheirPlaces();
    aPayloadHasItsParameters(); % with a payload
    fprintf('all tests passed\n');
end

function size = scale(value)
% Largest of 1 and the sizes of some entries.
    size = max([1; abs(value(:))]);
end

function agree(what, found, expected, tolerance)
% That values differ by no more than so much of the largest; what is not a number does not agree.
    assert(numel(found) == numel(expected), what);
    assert(all(abs(found(:) - expected(:)) <= tolerance * scale(expected)), [what, ': deviates']);
end

function t = rounding()
% Some thousand roundings; forward dynamics is judged by its residual.
    t = 4096 * eps;
end

function h = step()
% A power of two near the cube root of epsilon: differences of this step have errors of about its square.
    h = 1 / 131072;
end

function t = differences()
    t = 1e3 * step() ^ 2;
end

function row = byRows(value)
% The entries of matrices in a row, as they are written.
    row = permute(value, [2, 1, 3]);
    row = row(:);
end

function [q, dq, ddq, tau] = randomStates()
% Random states, the same on every machine: 20 columns.
    dof = getfield(robot.model(), 'dof');
    bits = 4711;
    all = zeros(4 * dof, 20);
    for k = 1:numel(all)
        bits = mod(bits * 16807, 2147483647);
        all(k) = bits / 1073741824 - 1;
    end
    q = 3 * all(1:dof, :);
    dq = 2 * all(dof + 1:2 * dof, :);
    ddq = 4 * all(2 * dof + 1:3 * dof, :);
    tau = 20 * all(3 * dof + 1:4 * dof, :);
end

function v = times(m, x)
% Matrices times vectors, page by page.
    v = zeros(size(m, 1), size(m, 3));
    for k = 1:size(m, 3)
        v(:, k) = m(:, :, k) * x(:, k);
    end
end

function compare(name, state, found, expected)
% A value from the equations.
    lost = 1;
    if strcmp(name, 'operationalInertia') || strncmp(name, 'forwardDynamics', 15)
        % An inverse loses what the condition of its matrix takes.
        lost = 256;
    end
    agree(sprintf('%s at state %d', name, state), found, expected, lost * rounding());
end

function forwardDynamicsSolvesTheEquationOfMotion(states)
    [q, dq, ~, tau] = randomStates();
    q = [q, states.q];
    dq = [dq, states.dq];
    tau = [tau, states.tau];
    ddq = robot.forwardDynamics(q, dq, tau);
    terms = times(robot.inertiaMatrix(q), ddq);
    agree('tau', robot.inverseDynamics(q, dq, ddq), tau, rounding() * scale(terms));
end

function inertiaMatrixIsSymmetricAndPositiveDefinite()
    b = robot.inertiaMatrix(randomStates());
    assert(isequal(b, permute(b, [2, 1, 3])), 'B is symmetric to the last bit');
    for k = 1:size(b, 3)
        [~, failed] = chol(b(:, :, k));
        assert(failed == 0, 'B is positive definite');
    end
end

function inertiaRatesMinusTwiceCoriolisAreSkew()
    [q, dq] = randomStates();
    h = step();
    rates = (robot.inertiaMatrix(q + h * dq) - robot.inertiaMatrix(q - h * dq)) / (2 * h);
    skew = rates - 2 * robot.coriolisMatrix(q, dq);
    sums = skew + permute(skew, [2, 1, 3]);
    assert(max(abs(sums(:))) <= differences() * scale(robot.inertiaMatrix(q)), 'dB/dt - 2C is skew-symmetric');
end

function torquesAreThoseOfTheMatricesAndOfTheRegressor()
    [q, dq, ddq] = randomStates();
    b = robot.inertiaMatrix(q);
    c = robot.coriolisMatrix(q, dq);
    g = robot.gravity(q);
    [inertia, coriolis, gravity] = robot.equationsOfMotion(q, dq);
    agree('equationsOfMotion', [inertia(:); coriolis(:); gravity(:)], [b(:); c(:); g(:)], rounding());
    tau = robot.inverseDynamics(q, dq, ddq);
    tau = tau - robot.loadFriction(q, dq); % with load friction
    agree('inverseDynamics', tau, times(b, ddq) + times(c, dq) + robot.friction(dq) + g, rounding());
    nominal = getfield(robot.model(), 'nominalParameters');
    y = robot.regressor(q, dq, dq, ddq);
    sums = times(y, repmat(nominal, 1, size(q, 2))) + robot.knownTorque(q, dq, dq, ddq);
    agree('Y pi + tau_known', sums, tau, rounding() * max(scale(nominal), scale(y)));
end

function functionsAtRunTimeParametersAreThePlainOnesAtTheNominalParameters()
    [q, dq, ddq] = randomStates();
    nominal = getfield(robot.model(), 'nominalParameters');
    t = rounding() * scale(nominal);
    agree('inertiaMatrixWith', robot.inertiaMatrixWith(nominal, q), robot.inertiaMatrix(q), t);
    agree('gravityWith', robot.gravityWith(nominal, q), robot.gravity(q), t);
    agree('inverseDynamicsWith', robot.inverseDynamicsWith(nominal, q, dq, ddq), robot.inverseDynamics(q, dq, ddq), t);
end

function gravityIsTheSlopeOfThePotentialEnergy()
    q = randomStates();
    g = robot.gravity(q);
    size_ = max(scale(robot.potentialEnergy(q)), scale(g));
    h = step();
    for k = 1:size(q, 1)
        along = zeros(size(q));
        along(k, :) = h;
        slope = (robot.potentialEnergy(q + along) - robot.potentialEnergy(q - along)) / (2 * h);
        assert(max(abs(slope - g(k, :))) <= differences() * size_, 'gravity is the slope of the potential energy');
    end
end

function parametersHaveTheirPlaces()
    m = robot.model();
    for k = 1:m.parameters
        assert(m.parameterIndex.(m.parameterNames{k}) == k, 'a parameter has its place');
    end
end
 % with a payload
function aPayloadHasItsParameters() % with a payload
% Steiner: 2 kg at (1, 2, 3), about the origin. % with a payload
    found = robot.payloadParameters(2, [1; 2; 3], [10, -1, -2; -1, 20, -3; -2, -3, 30]); % with a payload
    assert(isequal(found, [2; 2; 4; 6; 36; -5; 40; -8; -15; 40]), 'a payload has its parameters'); % with a payload
end % with a payload
