% REMARK
%
% q, dq, ddq and tau have one number for each axis: rad or m, and per s and s2; N m or N.
%
%   ROBOT.inverse_dynamics(q, dq, ddq)  the torques of this motion, friction included
%   ROBOT.gravity(q)                    the torques that hold the arm at q
%   ROBOT.mass_matrix(q)                the inertia matrix
%   ROBOT.friction(dq)                  friction and offsets alone
%
% A row of `body` is a link: the rotation of its frame to the one before at q = 0 (1-9), the origin
% there (10-12), 1 for a prismatic joint (13), Ixx, Ixy, Ixz, Iyy, Iyz, Izz, mx, my, mz, m (14-23),
% and the axis that moves it, from 0, with ratio and offset (24-26). A row of `joints`: viscous and
% Coulomb friction, forward and backward (1-4), Stribeck friction and its velocity (5, 6), smooth
% Coulomb friction and its velocity (7, 8), offset (9), friction with the square of the velocity (21).
classdef ROBOT
    properties (Constant)
ROBOT_TABLES
    end

    methods (Static)
        function tau = inverse_dynamics(q, dq, ddq)
            tau = ROBOT.rigid(q, dq, ddq, ROBOT.weight') + ROBOT.motors * ddq(:) + ROBOT.friction(dq);
        end

        function tau = gravity(q)
            tau = ROBOT.rigid(q, 0 * q, 0 * q, ROBOT.weight');
        end

        function M = mass_matrix(q)
            M = ROBOT.motors;
            for k = 1:numel(q)
                one = 0 * q;
                one(k) = 1;
                M(:, k) = M(:, k) + ROBOT.rigid(q, 0 * q, one, zeros(3, 1));
            end
        end

        function tau = friction(dq)
            v = dq(:);
            row = ROBOT.joints;
            ahead = v > 0;
            viscous = ahead .* row(:, 1) + (1 - ahead) .* row(:, 2);
            jump = ahead .* row(:, 3) + (1 - ahead) .* row(:, 4);
            jump = jump + row(:, 5) .* exp(-(v ./ row(:, 6)) .^ 2);
            tau = viscous .* v + sign(v) .* jump + row(:, 7) .* tanh(v ./ row(:, 8));
            tau = tau + row(:, 21) .* v .* abs(v) + row(:, 9);
            rows = ROBOT.couplings;
            for c = 1:size(rows, 1)
                one = rows(c, 1) + 1;
                two = rows(c, 2) + 1;
                s = sign(rows(c, 3) * v(one) + rows(c, 4) * v(two));
                tau(one) = tau(one) + rows(c, 5) * v(two) + rows(c, 3) * s * rows(c, 6);
                tau(two) = tau(two) + rows(c, 5) * v(one) + rows(c, 4) * s * rows(c, 6);
            end
        end

        % Recursive Newton-Euler (Luh, Walker and Paul 1980), all vectors in the frame of their link.
        function tau = rigid(q, dq, ddq, gravity)
            body = ROBOT.body;
            n = size(body, 1);
            z = [0; 0; 1];
            R = zeros(3, 3, n);
            p = zeros(3, n);
            F = zeros(3, n);
            N = zeros(3, n);
            w = zeros(3, 1);
            b = zeros(3, 1);
            a = -gravity;
            tau = zeros(numel(q), 1);
            for i = 1:n
                row = body(i, :)';
                k = row(24) + 1;
                x = row(25) * q(k) + row(26);
                v = row(25) * dq(k);
                acc = row(25) * ddq(k);
                turn = reshape(row(1:9), 3, 3)';
                p(:, i) = row(10:12);
                if row(13) == 1
                    p(:, i) = p(:, i) + turn(:, 3) * x;
                else
                    turn = turn * [cos(x), -sin(x), 0; sin(x), cos(x), 0; 0, 0, 1];
                end
                R(:, :, i) = turn;
                a = turn' * (a + cross(b, p(:, i)) + cross(w, cross(w, p(:, i))));
                w = turn' * w;
                b = turn' * b;
                if row(13) == 1
                    a = a + 2 * v * cross(w, z) + acc * z;
                else
                    b = b + v * cross(w, z) + acc * z;
                    w = w + v * z;
                end
                I = [row(14:16)'; row(15), row(17:18)'; row(16), row(18:19)'];
                mc = row(20:22);
                F(:, i) = row(23) * a + cross(b, mc) + cross(w, cross(w, mc));
                N(:, i) = I * b + cross(w, I * w) + cross(mc, a);
            end
            for i = n:-1:1
                k = body(i, 24) + 1;
                if body(i, 13) == 1
                    tau(k) = tau(k) + body(i, 25) * F(3, i);
                else
                    tau(k) = tau(k) + body(i, 25) * N(3, i);
                end
                if i > 1
                    f = R(:, :, i) * F(:, i);
                    F(:, i - 1) = F(:, i - 1) + f;
                    N(:, i - 1) = N(:, i - 1) + R(:, :, i) * N(:, i) + cross(p(:, i), f);
                end
            end
        end
    end
end
