function [sine, cosine] = sinCos(x)
% Sines and cosines of angles, rad.
    sine = sin(x);
    cosine = cos(x);
end
