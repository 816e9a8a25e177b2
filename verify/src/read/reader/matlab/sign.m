function s = signOf(x)
% Sign of a rate: 0 at rest, not a number for what is not a number.
    s = x;
    s(x > 0.0) = 1.0;
    s(x < 0.0) = -1.0;
end
