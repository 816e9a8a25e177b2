function s = signOf(x)
% @sign@
    s = x;
    s(x > 0.0) = 1.0;
    s(x < 0.0) = -1.0;
end
