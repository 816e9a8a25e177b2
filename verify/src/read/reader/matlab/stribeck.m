function s = stribeck(rate, velocity)
% exp(-|rate| / velocity), what is left of Stribeck friction at a rate, within 2 units of roundoff; 0 where it is below 1e-17, not a number for
% what is not a number. x = |rate| / velocity = n ln 2 + r with n the integer nearest to x / ln 2, after Cody and Waite (1980): the first part of
% ln 2 has 16 bits, so that its product with n is exact, and so is x less that. 2^-n is a product of powers of two; exp(-r) its series up to
% r^13 / 13!, which leaves out less than 2^-57.
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
