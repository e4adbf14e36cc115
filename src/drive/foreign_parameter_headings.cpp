// How people head the columns of their tables of parameters.
#include <array>

#include "drive/foreign_heading.hpp"

namespace servoctl::drive {
namespace {

constexpr std::string_view kIdExact[] = {
    "id",     "no",       "number",      "parameterno",   "parameternumber", "paramno",
    "parano", "paramid",  "parameterid", "parametercode", "functioncode",    "panel",
    "参数号", "参数编号", "编号",        "参数代码",      "功能码",          "参数码"};
constexpr std::string_view kIdLoose[] = {"parameter", "param", "code", "参数", "代码", "num", "pr", "pn"};
constexpr std::string_view kObjectExact[] = {
    "object",        "index",       "objectindex", "canindex", "canopenindex", "canopenobject",
    "objectaddress", "canopen索引", "can索引",     "字典索引", "对象地址",     "odindex",
    "对象",          "索引",        "主索引",      "对象索引", "对象字典",     "索引号"};
constexpr std::string_view kSubExact[] = {"sub", "subindex", "subidx", "子索引", "子索引号", "副索引"};
constexpr std::string_view kTypeExact[] = {"type", "datatype", "数据类型", "类型", "数据格式"};
constexpr std::string_view kTypeLoose[] = {"format"};
constexpr std::string_view kAccessExact[] = {"access", "rw",   "attribute", "accesstype", "属性",
                                             "访问",   "读写", "读写属性",  "访问权限",   "权限"};
constexpr std::string_view kUnitExact[] = {"unit", "units", "单位", "最小单位"};
constexpr std::string_view kScaleExact[] = {"scale"};
/// Whether the raw number is multiplied or divided by it, they do not say.
constexpr std::string_view kFactorExact[] = {
    "factor",   "scaling",    "scalefactor", "scalingfactor", "resolution",   "multiplier",  "multiplicator",
    "divisor",  "divider",    "decimals",    "decimalplaces", "decimalpoint", "coefficient", "ratio",
    "比例",     "系数",       "倍率",        "精度",          "分辨率",       "缩放",        "缩放系数",
    "缩放因子", "比例系数",   "换算系数",    "放大倍数",      "倍数",         "小数位",      "小数位数",
    "小数点",   "小数点位数", "除数"};
constexpr std::string_view kDefaultExact[] = {"default",
                                              "defaultvalue",
                                              "factory",
                                              "factorydefault",
                                              "factorysetting",
                                              "factoryvalue",
                                              "initial",
                                              "initialvalue",
                                              "defaultsetting",
                                              "initialsetting",
                                              "factorydefaultvalue",
                                              "def",
                                              "默认",
                                              "默认值",
                                              "出厂设置",
                                              "默认设置",
                                              "出厂值",
                                              "出厂设定",
                                              "出厂设定值",
                                              "出厂默认",
                                              "出厂默认值",
                                              "缺省",
                                              "缺省值",
                                              "初始值"};
constexpr std::string_view kMinExact[] = {"min",   "minimum", "minvalue", "lowerlimit", "lowlimit",
                                          "lower", "最小值",  "最小",     "下限"};
constexpr std::string_view kMaxExact[] = {"max",   "maximum", "maxvalue", "upperlimit", "highlimit",
                                          "upper", "最大值",  "最大",     "上限"};
constexpr std::string_view kRangeExact[] = {"range",         "settingrange", "setrange",   "valuerange",
                                            "rangeofvalues", "范围",         "设定范围",   "取值范围",
                                            "设置范围",      "参数范围",     "设定值范围", "数据范围"};
constexpr std::string_view kEffectExact[] = {"effect",        "effective",     "takeseffect",   "activation",
                                             "effectivetime", "wheneffective", "effectivewhen", "生效",
                                             "生效方式",      "生效时间",      "生效时机",      "更改生效"};
constexpr std::string_view kNameExact[] = {"name", "parametername", "designation", "title",   "englishname",
                                           "名称", "参数名称",      "参数名",      "英文名称"};
constexpr std::string_view kNameLoose[] = {"parameter", "function", "description", "功能", "参数", "meaning"};
constexpr std::string_view kNameZhExact[] = {"namezh", "chinesename", "chinese",
                                             "中文",   "中文名",      "中文名称"};
constexpr std::string_view kEnumExact[] = {"enum", "options", "selection", "选项", "枚举"};
constexpr std::string_view kEnumZhExact[] = {"enumzh"};
constexpr std::string_view kGroupExact[] = {"group", "category", "分组", "类别"};
constexpr std::string_view kNoteExact[] = {"note",     "notes", "remark", "remarks", "comment",
                                           "comments", "备注",  "说明",   "注释",    "描述"};
constexpr std::string_view kNoteLoose[] = {"function", "description", "功能", "meaning"};
constexpr std::string_view kNoteZhExact[] = {"notezh"};

constexpr auto kHeadings =
    std::to_array<Heading>({{"id", kIdExact, kIdLoose},           {"object", kObjectExact, {}, true},
                            {"sub", kSubExact, {}, true},         {"type", kTypeExact, kTypeLoose},
                            {"access", kAccessExact, {}},         {"unit", kUnitExact, {}},
                            {"scale", kScaleExact, {}, true},     {"factor", kFactorExact, {}},
                            {"default", kDefaultExact, {}, true}, {"min", kMinExact, {}, true},
                            {"max", kMaxExact, {}, true},         {"range", kRangeExact, {}, true},
                            {"effect", kEffectExact, {}},         {"name", kNameExact, kNameLoose},
                            {"name_zh", kNameZhExact, {}},        {"enum", kEnumExact, {}},
                            {"enum_zh", kEnumZhExact, {}},        {"group", kGroupExact, {}},
                            {"note", kNoteExact, kNoteLoose},     {"note_zh", kNoteZhExact, {}}});

}  // namespace

std::span<const Heading> parameter_headings() { return kHeadings; }

}  // namespace servoctl::drive
