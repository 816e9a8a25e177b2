function s = stribeck(rate, velocity)
% @stribeck@
    x = abs(rate) / velocity;
    n = zeros(size(x));
    power = ones(size(x));
    rest = x + 0.3465728759765625;
    counts = [32.0, 16.0, 8.0, 4.0, 2.0, 1.0];
    factors = [2.3283064365386963e-10, 1.52587890625e-5, 0.00390625, 0.0625, 0.25, 0.5];
    for i = 1:6
        more = rest >= counts(i) * 0.693145751953125;
        rest(more) = rest(more) - counts(i) * 0.693145751953125;
        n(more) = n(more) + counts(i);
        power(more) = power(more) * factors(i);
    end
    r = (x - n * 0.693145751953125) - n * 1.4286068203094173e-6;
    series = zeros(size(x));
    coefficients = [1.6059043836821613e-10, 2.08767569878681e-9, 2.505210838544172e-8, 2.755731922398589e-7, ...
        2.7557319223985893e-6, 2.48015873015873e-5, 0.0001984126984126984, 0.001388888888888889, ...
        0.008333333333333333, 0.041666666666666664, 0.16666666666666666, 0.5];
    for i = 1:12
        series = coefficients(i) - r .* series;
    end
    s = power .* (1.0 - (r - r .* r .* series));
    s(x > 40.0) = 0.0;
end
