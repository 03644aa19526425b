"""Column names in Chinese and Japanese, put into the English words that are recognised."""

import re

_WORDS = {
    "time": "时间 時間 时刻 時刻",
    "timestamp": "时间戳",
    "joint": "关节 關節 関節",
    "axis": "轴 軸",
    "motor": "电机 电动机 馬達 モータ モーター",
    "position": "位置",
    "angle": "角度 转角 関節角",
    "velocity": "速度 角速度 转速",
    "torque": "力矩 扭矩 转矩 轉矩 トルク",
    "current": "电流 電流",
    "temperature": "温度 溫度",
    "actual": "实际 實際 反馈 回馈 测量 实测 実測 現在",
    "target": "目标 目標 期望 指令 给定 参考 命令",
}
_ENGLISH = {text: word for word, texts in _WORDS.items() for text in texts.split()}
_ANY = re.compile("|".join(sorted(_ENGLISH, key=len, reverse=True)))
_LEFT = re.compile(r"[\u3040-\u30ff\u3400-\u9fff]+")


def in_english(name: str) -> str:
    """Return a name with its Chinese and Japanese words in English, ``unlike`` for unknown ones.

    What is not known may say that a value is of another kind: ``重力矩`` is a torque of gravity.

    Examples
    --------
    >>> in_english("关节1位置(rad)")
    'joint 1 position (rad)'
    >>> in_english("重力矩")
    'unlike torque'
    """
    if _LEFT.search(name) is None:
        return name
    words = _LEFT.sub(" unlike ", _ANY.sub(lambda found: f" {_ENGLISH[found[0]]} ", name))
    return " ".join(words.split())


def known_words(text: str) -> frozenset[str]:
    """Return the known Chinese and Japanese words of a text.

    Examples
    --------
    >>> sorted(known_words("关节1位置;力矩"))
    ['位置', '关节', '力矩']
    """
    return frozenset(_ANY.findall(text))
