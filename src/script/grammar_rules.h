#pragma once
// The grammar of the language. Included by grammar.cc alone: PEGTL's templates are compiled once.

#include <tao/pegtl.hpp>
#include <tao/pegtl/contrib/parse_tree.hpp>

namespace patina {

namespace rules {

using namespace tao::pegtl;

// ---- words -----------------------------------------------------------------------------------------------------

struct blanks : star<one<' ', '\t', '\r'>> {};
struct word : identifier {};

template <typename String>
struct keyword : seq<String, not_at<identifier_other>> {};

struct newWord : keyword<TAO_PEGTL_STRING("new")> {};
struct openWord : keyword<TAO_PEGTL_STRING("open")> {};
struct coatWord : keyword<TAO_PEGTL_STRING("coat")> {};
struct erodeWord : keyword<TAO_PEGTL_STRING("erode")> {};
struct growWord : keyword<TAO_PEGTL_STRING("grow")> {};
struct convertWord : keyword<TAO_PEGTL_STRING("convert")> {};
struct fillWord : keyword<TAO_PEGTL_STRING("fill")> {};
struct polishWord : keyword<TAO_PEGTL_STRING("polish")> {};
struct offsetWord : keyword<TAO_PEGTL_STRING("offset")> {};
struct renderWord : keyword<TAO_PEGTL_STRING("render")> {};
struct letWord : keyword<TAO_PEGTL_STRING("let")> {};
struct paramWord : keyword<TAO_PEGTL_STRING("param")> {};
struct curveWord : keyword<TAO_PEGTL_STRING("curve")> {};
struct seedWord : keyword<TAO_PEGTL_STRING("seed")> {};
struct repeatWord : keyword<TAO_PEGTL_STRING("repeat")> {};

struct asWord : keyword<TAO_PEGTL_STRING("as")> {};
struct byWord : keyword<TAO_PEGTL_STRING("by")> {};
struct andWord : keyword<TAO_PEGTL_STRING("and")> {};
struct aboveWord : keyword<TAO_PEGTL_STRING("above")> {};
struct windowWord : keyword<TAO_PEGTL_STRING("window")> {};
struct ofWord : keyword<TAO_PEGTL_STRING("of")> {};
struct tangentWord : keyword<TAO_PEGTL_STRING("tangent")> {};
struct tangentSphereWord : keyword<TAO_PEGTL_STRING("tangent-sphere")> {};
struct globalWord : keyword<TAO_PEGTL_STRING("global")> {};
struct everywhereWord : keyword<TAO_PEGTL_STRING("everywhere")> {};
struct toWord : keyword<TAO_PEGTL_STRING("to")> {};
struct fullWord : keyword<TAO_PEGTL_STRING("full")> {};
struct smoothWord : keyword<TAO_PEGTL_STRING("smooth")> {};
struct hardnessWord : keyword<TAO_PEGTL_STRING("hardness")> {};
struct metalWord : keyword<TAO_PEGTL_STRING("metal")> {};
struct areaWord : keyword<TAO_PEGTL_STRING("area")> {};

struct statementWord : sor<newWord, openWord, coatWord, erodeWord, growWord, convertWord, fillWord, polishWord,
                           offsetWord, renderWord, letWord, paramWord, curveWord, seedWord, repeatWord> {};
struct reserved : sor<statementWord, asWord, byWord, andWord, aboveWord, windowWord, ofWord, tangentWord, globalWord,
                      everywhereWord, toWord, fullWord> {};
struct name : seq<not_at<reserved>, word> {};

// A rule that must match: its message (below) is the error, at the place where it was tried.
template <typename Self, typename Rule>
struct wanted : sor<Rule, raise<Self>> {};

// ---- numbers ---------------------------------------------------------------------------------------------------

struct digits : plus<digit> {};
struct exponent : seq<one<'e', 'E'>, opt<one<'+', '-'>>, digits> {};
struct numberText : seq<sor<seq<digits, opt<one<'.'>, star<digit>>>, seq<one<'.'>, digits>>, opt<exponent>> {};
// MICRO SIGN and GREEK SMALL LETTER MU look the same and are both on keyboards.
struct micro : sor<string<'\xC2', '\xB5'>, string<'\xCE', '\xBC'>> {};
struct attachedUnit : plus<sor<identifier_other, micro>> {};
struct unitWord : seq<sor<TAO_PEGTL_STRING("nm"), TAO_PEGTL_STRING("um"), TAO_PEGTL_STRING("mm"),
                          TAO_PEGTL_STRING("cm"), TAO_PEGTL_STRING("m"), seq<micro, one<'m'>>>,
                      not_at<identifier_other>> {};
struct quantity : seq<numberText, opt<sor<attachedUnit, seq<blanks, unitWord>>>> {};

struct wantNumber : wanted<wantNumber, quantity> {};

struct quoteEnd : one<'"'> {};
struct quotedText : star<not_one<'"'>> {};
struct quoted : seq<one<'"'>, quotedText, quoteEnd> {};

// ---- expressions -----------------------------------------------------------------------------------------------

struct sum;
struct wantSum : wanted<wantSum, sum> {};
struct wantClose : wanted<wantClose, one<')'>> {};
struct comma : seq<one<','>, blanks> {};

struct rateName : plus<alpha> {};
struct stepDigits : digits {};
struct totalDigits : digits {};
struct shortRest
    : seq<one<'.'>, rateName, one<'_'>, stepDigits, one<'.'>, totalDigits, not_at<sor<one<'.'>, identifier_other>>> {};
struct wantShortRest : wanted<wantShortRest, shortRest> {};
struct growthShort : seq<name, at<one<'.'>>, wantShortRest> {};

struct argumentName : seq<word, at<blanks, one<'='>>> {};
struct argument : seq<opt<argumentName, blanks, one<'='>, blanks>, wantSum> {};
struct arguments : opt<not_at<one<')'>>, argument, star<comma, argument>> {};
// Only a function of the language may stand apart from its '(': behind a thickness, `t (1 - wetness)` is two things.
struct functionWord
    : keyword<sor<TAO_PEGTL_STRING("texture"), TAO_PEGTL_STRING("vertices"), TAO_PEGTL_STRING("noise"),
                  TAO_PEGTL_STRING("turbulence"), TAO_PEGTL_STRING("accessibility"), TAO_PEGTL_STRING("facing"),
                  TAO_PEGTL_STRING("min"), TAO_PEGTL_STRING("max"), TAO_PEGTL_STRING("clamp"), TAO_PEGTL_STRING("mix"),
                  TAO_PEGTL_STRING("pow"), TAO_PEGTL_STRING("smoothstep"), TAO_PEGTL_STRING("DPD_BS"),
                  TAO_PEGTL_STRING("DPD"), TAO_PEGTL_STRING("RDR"), TAO_PEGTL_STRING("RD"), TAO_PEGTL_STRING("BD"),
                  TAO_PEGTL_STRING("ST")>> {};
struct functionName : seq<at<functionWord>, word> {};
struct calledName : sor<seq<functionName, at<blanks, one<'('>>>, seq<name, at<one<'('>>>> {};
struct call : seq<calledName, blanks, one<'('>, blanks, arguments, wantClose> {};
struct group : seq<one<'('>, blanks, wantSum, star<comma, wantSum>, wantClose> {};
struct ofFull : seq<ofWord, plus<one<' ', '\t', '\r'>>, fullWord> {};

struct primary : sor<quantity, quoted, group, growthShort, call, name> {};
struct wantPrimary : wanted<wantPrimary, primary> {};
struct sign : one<'+', '-'> {};
struct factor : seq<sor<seq<plus<sign, blanks>, wantPrimary>, primary>, blanks, opt<ofFull, blanks>> {};
struct wantFactor : wanted<wantFactor, factor> {};
struct productOperator : one<'*', '/'> {};
struct product : seq<factor, star<productOperator, blanks, wantFactor>> {};
struct wantProduct : wanted<wantProduct, product> {};
struct sumOperator : one<'+', '-'> {};
struct sum : seq<product, star<sumOperator, blanks, wantProduct>> {};

// ---- statements ------------------------------------------------------------------------------------------------

struct material : name {};
struct wantMaterial : wanted<wantMaterial, material> {};
struct wantMetal : wanted<wantMetal, material> {};
struct declared : word {};
struct wantDeclared : wanted<wantDeclared, declared> {};
struct label : word {};
struct wantLabel : wanted<wantLabel, label> {};
struct target : word {};
struct wantTarget : wanted<wantTarget, target> {};
struct fileName : quoted {};
struct wantFile : wanted<wantFile, fileName> {};
struct wantTo : wanted<wantTo, toWord> {};
struct wantEquals : wanted<wantEquals, one<'='>> {};
struct value : sum {};
struct wantThickness : wanted<wantThickness, value> {};
struct wantFraction : wanted<wantFraction, value> {};
struct wantHeight : wanted<wantHeight, value> {};
struct wantRadius : wanted<wantRadius, value> {};
struct wantCount : wanted<wantCount, value> {};
struct wantValue : wanted<wantValue, value> {};
struct map : sum {};
struct point : group {};
struct wantPoint : wanted<wantPoint, point> {};
struct areaMark : areaWord {};

struct wantHardness : wanted<wantHardness, hardnessWord> {};
struct wantMetalWord : wanted<wantMetalWord, metalWord> {};
struct wantSmooth : wanted<wantSmooth, seq<smoothWord, blanks, one<'('>>> {};
struct wantSphere : wanted<wantSphere, tangentSphereWord> {};
struct asClause : seq<asWord, blanks, wantLabel, blanks> {};
struct byClause : seq<byWord, blanks, wantHardness, blanks> {};
struct andClause : seq<andWord, blanks, wantMetalWord, blanks> {};
struct aboveClause : seq<aboveWord, blanks, wantSmooth, blanks, wantRadius, wantClose, blanks> {};
struct windowClause : seq<windowWord, blanks, wantRadius, blanks> {};
struct ofClause : seq<ofWord, blanks, wantMaterial, blanks> {};
struct tangentClause : seq<at<tangentWord>, wantSphere, blanks, wantThickness, blanks> {};
struct globalClause : seq<globalWord, blanks> {};
struct everywhereClause : seq<everywhereWord, blanks> {};
struct clauses
    : star<sor<asClause, byClause, andClause, aboveClause, windowClause, ofClause, tangentClause, globalClause,
               everywhereClause>> {};

struct newStatement : seq<newWord, blanks, wantMetal, blanks> {};
struct openStatement : seq<openWord, blanks, wantFile, blanks> {};
struct coatStatement : seq<coatWord, blanks, wantMaterial, blanks, wantThickness, opt<map>, clauses> {};
struct erodeStatement : seq<erodeWord, blanks, wantThickness, opt<map>, clauses> {};
struct growStatement : seq<growWord, blanks, wantMaterial, blanks, wantThickness, opt<map>, clauses> {};
struct convertStatement : seq<convertWord, blanks, wantMaterial, blanks, wantTo, blanks, wantMaterial, blanks,
                              wantFraction, opt<map>, clauses> {};
struct fillStatement : seq<fillWord, blanks, wantMaterial, blanks, wantHeight, opt<map>, clauses> {};
struct polishStatement
    : seq<polishWord, blanks, sor<seq<areaMark, blanks, wantFraction>, wantHeight>, opt<map>, clauses> {};
struct offsetStatement : seq<offsetWord, blanks, wantMaterial, blanks, wantRadius, clauses> {};
struct renderStatement : seq<renderWord, blanks, wantTarget, blanks> {};
struct letStatement : seq<letWord, blanks, wantDeclared, blanks, wantEquals, blanks, wantValue> {};
struct paramStatement : seq<paramWord, blanks, wantDeclared, blanks, wantEquals, blanks, wantValue> {};
struct smoothMark : smoothWord {};
struct curveStatement : seq<curveWord, blanks, wantDeclared, blanks, wantEquals, blanks, wantPoint, blanks, opt<comma>,
                            star<point, blanks, opt<comma>>, opt<smoothMark, blanks>> {};
struct seedStatement : seq<seedWord, blanks, wantCount, blanks> {};
struct repeatStatement : seq<repeatWord, blanks, wantCount, blanks> {};

struct statement : sor<newStatement, openStatement, coatStatement, erodeStatement, growStatement, convertStatement,
                       fillStatement, polishStatement, offsetStatement, renderStatement, letStatement, paramStatement,
                       curveStatement, seedStatement, repeatStatement> {};
struct wantEnd : wanted<wantEnd, eof> {};
struct wholeStatement : seq<statement, blanks, wantEnd> {};
struct wholeQuantity : seq<blanks, opt<sign>, blanks, wantNumber, blanks, wantEnd> {};

// ---- messages --------------------------------------------------------------------------------------------------

template <typename Rule>
inline constexpr const char* message = nullptr;
template <>
inline constexpr const char* message<wantSum> = "expected a number, a map or '('";
template <>
inline constexpr const char* message<wantPrimary> = message<wantSum>;
template <>
inline constexpr const char* message<wantFactor> = message<wantSum>;
template <>
inline constexpr const char* message<wantProduct> = message<wantSum>;
template <>
inline constexpr const char* message<wantNumber> = "expected a number";
template <>
inline constexpr const char* message<wantClose> = "expected ',' or ')'";
template <>
inline constexpr const char* message<wantShortRest> =
    "expected a growth pattern's short form, NAME.rate_step.total (such as BD.linear_1.20)";
template <>
inline constexpr const char* message<wantMaterial> = "expected the name of a material";
template <>
inline constexpr const char* message<wantMetal> = "expected the name of a metal";
template <>
inline constexpr const char* message<wantDeclared> = "expected a name to declare";
template <>
inline constexpr const char* message<wantLabel> = "expected a name behind 'as'";
template <>
inline constexpr const char* message<wantTarget> = "expected what to render, such as 'maps'";
template <>
inline constexpr const char* message<wantFile> = "expected the name of a volume's file in quotes";
template <>
inline constexpr const char* message<wantTo> = "expected 'to'";
template <>
inline constexpr const char* message<wantEquals> = "expected '='";
template <>
inline constexpr const char* message<wantThickness> = "expected a thickness";
template <>
inline constexpr const char* message<wantFraction> = "expected a fraction (0 to 1)";
template <>
inline constexpr const char* message<wantHeight> = "expected a height";
template <>
inline constexpr const char* message<wantRadius> = "expected a radius";
template <>
inline constexpr const char* message<wantCount> = "expected a whole number";
template <>
inline constexpr const char* message<wantValue> = "expected a value";
template <>
inline constexpr const char* message<wantPoint> = "expected a point, (year, value)";
template <>
inline constexpr const char* message<wantHardness> = "expected 'hardness' behind 'by'";
template <>
inline constexpr const char* message<wantMetalWord> = "expected 'metal' behind 'and'";
template <>
inline constexpr const char* message<wantSmooth> = "expected 'smooth(radius)' behind 'above'";
template <>
inline constexpr const char* message<wantSphere> = "expected 'tangent-sphere'";
template <>
inline constexpr const char* message<wantEnd> = "expected the end of the statement (';' or a new line)";

struct Messages {
    template <typename Rule>
    static constexpr const char* message = rules::message<Rule>;
};
template <typename Rule>
using control = must_if<Messages, normal, false>::control<Rule>;

template <typename Rule>
using selector =
    parse_tree::selector<Rule, parse_tree::store_content::on<
                                   name, functionName, numberText, attachedUnit, unitWord, quotedText, quoted, quantity,
                                   rateName, stepDigits, totalDigits, growthShort, argumentName, argument, call, group,
                                   ofFull, sign, factor, productOperator, product, sumOperator, sum, material, declared,
                                   label, target, fileName, value, map, point, areaMark, smoothMark, asClause, byClause,
                                   andClause, aboveClause, windowClause, ofClause, tangentClause, globalClause,
                                   everywhereClause>>;

} // namespace rules

} // namespace patina
