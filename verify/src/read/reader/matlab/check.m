function check(name, value, rows, n)
% That an argument has a column for each of n states, or one for all.
    if ~isa(value, 'double') || ~isreal(value)
        error('armgen:type', '%s: real numbers of double precision are wanted', name);
    end
    if ndims(value) ~= 2 || size(value, 1) ~= rows || (size(value, 2) ~= n && size(value, 2) ~= 1)
        error('armgen:size', '%s is %d x %d where %d x 1 is wanted, a column for each state', name, size(value, 1), size(value, 2), rows);
    end
end
