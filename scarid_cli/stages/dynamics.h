/* REMARK
 *
 * C99 without dependencies. q, dq, ddq and tau have ROBOT_AXES numbers: rad or m, and per s and s2;
 * N m or N. Include it where it is used; all functions are static.
 *
 *   ROBOT_inverse_dynamics(q, dq, ddq, tau)  the torques of this motion, friction included
 *   ROBOT_gravity(q, tau)                    the torques that hold the arm at q
 *   ROBOT_mass_matrix(q, M)                  the inertia matrix, row by row
 *   ROBOT_friction(dq, tau)                  friction and offsets alone
 *
 * A row of `body` is a link: the rotation of its frame to the one before at q = 0 [0-8], the origin
 * there [9-11], 1 for a prismatic joint [12], Ixx, Ixy, Ixz, Iyy, Iyz, Izz, mx, my, mz, m [13-22],
 * and the axis that moves it with ratio and offset [23-25]. A row of `joints`: viscous and Coulomb
 * friction, forward and backward [0-3], Stribeck friction and its velocity [4, 5], smooth Coulomb
 * friction and its velocity [6, 7], offset [8], friction with the square of the velocity [20].
 */
#ifndef ROBOT_DYNAMICS_H
#define ROBOT_DYNAMICS_H

#include <math.h>

ROBOT_TABLES

/* x = R' y or x = R y for the rotation R of the frame of a link to the one before it. */
static inline void ROBOT_into(const double *R, const double *y, double *x)
{
    for (int k = 0; k < 3; k++)
        x[k] = R[k] * y[0] + R[3 + k] * y[1] + R[6 + k] * y[2];
}

static inline void ROBOT_back(const double *R, const double *y, double *x)
{
    for (int k = 0; k < 3; k++)
        x[k] = R[3 * k] * y[0] + R[3 * k + 1] * y[1] + R[3 * k + 2] * y[2];
}

static inline void ROBOT_add_cross(const double *a, const double *b, double *x)
{
    x[0] += a[1] * b[2] - a[2] * b[1];
    x[1] += a[2] * b[0] - a[0] * b[2];
    x[2] += a[0] * b[1] - a[1] * b[0];
}

/* Recursive Newton-Euler (Luh, Walker and Paul 1980), all vectors in the frame of their link. */
static inline void ROBOT_rigid(const double *q, const double *dq, const double *ddq,
                        const double *gravity, double *tau)
{
    double R[ROBOT_LINKS][9], p[ROBOT_LINKS][3], F[ROBOT_LINKS][3], N[ROBOT_LINKS][3];
    double w[3] = {0}, b[3] = {0}, a[3];
    for (int k = 0; k < 3; k++)
        a[k] = -gravity[k];
    for (int i = 0; i < ROBOT_AXES; i++)
        tau[i] = 0.0;
    for (int i = 0; i < ROBOT_LINKS; i++) {
        const double *row = ROBOT_model.body[i];
        const int axis = (int)row[23], slides = row[12] != 0.0;
        const double x = row[24] * q[axis] + row[25];
        const double v = row[24] * dq[axis], acc = row[24] * ddq[axis];
        const double c = slides ? 1.0 : cos(x), s = slides ? 0.0 : sin(x);
        double u[3] = {0}, at[3], turned[3];
        for (int k = 0; k < 3; k++) {
            R[i][3 * k] = c * row[3 * k] + s * row[3 * k + 1];
            R[i][3 * k + 1] = c * row[3 * k + 1] - s * row[3 * k];
            R[i][3 * k + 2] = row[3 * k + 2];
            p[i][k] = row[9 + k] + (slides ? row[3 * k + 2] * x : 0.0);
            at[k] = a[k];
        }
        ROBOT_add_cross(w, p[i], u);
        ROBOT_add_cross(b, p[i], at);
        ROBOT_add_cross(w, u, at);
        ROBOT_into(R[i], at, a);
        ROBOT_into(R[i], w, turned);
        for (int k = 0; k < 3; k++)
            w[k] = turned[k];
        ROBOT_into(R[i], b, turned);
        for (int k = 0; k < 3; k++)
            b[k] = turned[k];
        if (slides) {
            a[0] += 2.0 * w[1] * v;
            a[1] -= 2.0 * w[0] * v;
            a[2] += acc;
        } else {
            b[0] += w[1] * v;
            b[1] -= w[0] * v;
            b[2] += acc;
            w[2] += v;
        }
        const double *I = row + 13, *mc = row + 19, m = row[22];
        const double h[3] = {I[0] * w[0] + I[1] * w[1] + I[2] * w[2],
                             I[1] * w[0] + I[3] * w[1] + I[4] * w[2],
                             I[2] * w[0] + I[4] * w[1] + I[5] * w[2]};
        double wc[3] = {0};
        ROBOT_add_cross(w, mc, wc);
        for (int k = 0; k < 3; k++)
            F[i][k] = m * a[k];
        ROBOT_add_cross(b, mc, F[i]);
        ROBOT_add_cross(w, wc, F[i]);
        N[i][0] = I[0] * b[0] + I[1] * b[1] + I[2] * b[2];
        N[i][1] = I[1] * b[0] + I[3] * b[1] + I[4] * b[2];
        N[i][2] = I[2] * b[0] + I[4] * b[1] + I[5] * b[2];
        ROBOT_add_cross(w, h, N[i]);
        ROBOT_add_cross(mc, a, N[i]);
    }
    for (int i = ROBOT_LINKS - 1; i >= 0; i--) {
        const double *row = ROBOT_model.body[i];
        tau[(int)row[23]] += row[24] * (row[12] != 0.0 ? F[i][2] : N[i][2]);
        if (i > 0) {
            double f[3], n[3];
            ROBOT_back(R[i], F[i], f);
            ROBOT_back(R[i], N[i], n);
            ROBOT_add_cross(p[i], f, n);
            for (int k = 0; k < 3; k++) {
                F[i - 1][k] += f[k];
                N[i - 1][k] += n[k];
            }
        }
    }
}

static inline void ROBOT_friction(const double *dq, double *tau)
{
    for (int i = 0; i < ROBOT_AXES; i++) {
        const double *row = ROBOT_model.joints[i], v = dq[i];
        const double s = (v > 0.0) - (v < 0.0), ratio = v / row[5];
        tau[i] = (v > 0.0 ? row[0] : row[1]) * v;
        tau[i] += s * ((v > 0.0 ? row[2] : row[3]) + row[4] * exp(-ratio * ratio));
        tau[i] += row[6] * tanh(v / row[7]) + row[20] * v * fabs(v) + row[8];
    }
    for (int c = 0; c < ROBOT_COUPLINGS; c++) {
        const double *row = ROBOT_model.couplings[c];
        const int one = (int)row[0], two = (int)row[1];
        const double slip = row[2] * dq[one] + row[3] * dq[two];
        const double s = (slip > 0.0) - (slip < 0.0);
        tau[one] += row[4] * dq[two] + row[2] * s * row[5];
        tau[two] += row[4] * dq[one] + row[3] * s * row[5];
    }
}

static inline void ROBOT_inverse_dynamics(const double *q, const double *dq, const double *ddq,
                                   double *tau)
{
    double rub[ROBOT_AXES];
    ROBOT_rigid(q, dq, ddq, ROBOT_model.gravity, tau);
    ROBOT_friction(dq, rub);
    for (int i = 0; i < ROBOT_AXES; i++) {
        tau[i] += rub[i];
        for (int j = 0; j < ROBOT_AXES; j++)
            tau[i] += ROBOT_model.motors[i][j] * ddq[j];
    }
}

static inline void ROBOT_gravity(const double *q, double *tau)
{
    const double zero[ROBOT_AXES] = {0};
    ROBOT_rigid(q, zero, zero, ROBOT_model.gravity, tau);
}

static inline void ROBOT_mass_matrix(const double *q, double *M)
{
    const double zero[ROBOT_AXES] = {0}, none[3] = {0};
    for (int j = 0; j < ROBOT_AXES; j++) {
        double one[ROBOT_AXES] = {0}, column[ROBOT_AXES];
        one[j] = 1.0;
        ROBOT_rigid(q, zero, one, none, column);
        for (int i = 0; i < ROBOT_AXES; i++)
            M[ROBOT_AXES * i + j] = column[i] + ROBOT_model.motors[i][j];
    }
}

#endif
