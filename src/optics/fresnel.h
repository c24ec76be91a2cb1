#pragma once
// Reflection at smooth interfaces, and Saunderson's correction for the one between a film and the air.

namespace patina {

/// Normal-incidence reflectance of a medium n + i k seen from a transparent medium of index `outside`.
double normalReflectance(double n, double k, double outside = 1.0);

/// Fresnel reflectance for unpolarised light going into a dielectric of relative index `eta` (> 0), `cosine` 0…1.
/// With eta < 1 it is 1 beyond the critical angle.
double dielectricReflectance(double cosine, double eta);

/// Reflectance of a smooth interface for diffuse light: outside in (`external`), and inside out (`internal`).
/// external = 2 ∫ F(c) c dc; internal = 1 - (1 - external) / n². Tabulated for n in 1…4, exact at the table's nodes.
struct DiffuseInterface {
    double external = 0.0;
    double internal = 0.0;
};
DiffuseInterface diffuseInterface(double index);

/// Saunderson 1942: reflectance seen from outside of a body of reflectance R under an interface which reflects k1 of
/// the incoming light and k2 of the diffuse light from within.
double saunderson(double internalReflectance, double k1, double k2);
/// The body's reflectance from the one measured outside, not below 0.
double inverseSaunderson(double measuredReflectance, double k1, double k2);

} // namespace patina
